//! The threads that compute, and the memory to start with.

use std::num::NonZero;

use bytesize::ByteSize;
use clap::Args;

/// The option of every verb that computes in parallel.
#[derive(Debug, Args)]
pub(super) struct ThreadArgs {
    /// Number of threads; it does not change the result [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
}

/// More than any machine's cores.
const MOST_THREADS: usize = 1024;

/// The stack of a thread, in bytes, whatever the environment says.
const THREAD_STACK: usize = 2 << 20;

/// The program's memory beside its frames, in bytes, with a margin.
pub(super) const STARTING_MEMORY: usize = 32 << 20;

/// Checks that the system grants `bytes` of memory: a small allocation that fails later ends the process.
pub(super) fn check_memory(bytes: usize) -> anyhow::Result<()> {
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| {
        let size = ByteSize(bytes as u64);
        anyhow::anyhow!(
            "not enough memory to start: {size} are needed; allow more, or use fewer --threads"
        )
    })
}

/// Starts all threads. Otherwise rayon starts them at the first parallel loop, and panics where the system refuses one.
pub(super) fn start_threads(threads: Option<u16>) -> anyhow::Result<()> {
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    let count = threads.map_or_else(cores, usize::from).min(MOST_THREADS);
    check_memory(count.saturating_mul(THREAD_STACK) + STARTING_MEMORY)?;
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .stack_size(THREAD_STACK)
        .build_global()
        .map_err(|error| {
            anyhow::anyhow!("the threads cannot be started ({error}); use fewer with --threads")
        })
}
