//! The program as a whole, run in temporary folders: what it prints, writes, refuses and survives.

#[path = "../common/process.rs"]
mod process;
#[path = "../common/reference_rays.rs"]
mod reference_rays;

mod harness;
mod tools;

mod animations;
mod anything_typed;
mod chart;
mod cli;
mod crash_only;
mod determinism;
mod disk_faults;
mod encoders;
mod farm;
mod formats;
mod long_runs;
mod outputs;
mod pages;
mod readers;
mod run_messages;
mod sharing;
mod skies;
mod sky_faults;
mod table_faults;
