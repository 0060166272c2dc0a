//! The window of `darkness view`, in a virtual display: Xvfb shows it, xdotool is the hand, xwd takes its pixels.
#![cfg(target_os = "linux")]

#[path = "../common/process.rs"]
mod process;
#[path = "../common/tables.rs"]
mod tables;
#[path = "../program/tools.rs"]
mod tools;

mod display;

mod files;
mod hand;
mod keys;
mod long_use;
mod without_display;
