//! What the machine may be asked for: threads, a graphics adapter.

#[cfg(feature = "gpu")]
use umbrage::gpu::Gpu;

use super::error::Failure;

/// For commands that may be long.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct ThreadArgs {
    /// How many threads work, from 1 to 1024; the result is the same for any number [default: one a core]
    #[arg(long, value_name = "N", value_parser = parse_threads, allow_negative_numbers = true)]
    threads: Option<usize>,
}

impl ThreadArgs {
    /// Prepares the threads; call it once, before the work.
    pub(crate) fn apply(self) -> Result<(), Failure> {
        let Some(threads) = self.threads else { return Ok(()) };
        start(threads)
            .map_err(|problem| Failure::new(format!("--threads {threads}: {problem}"), "leave it out"))
    }
}

/// Far more than help; each thread takes memory.
const MOST_THREADS: usize = 1024;

fn parse_threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads) if (1..=MOST_THREADS).contains(&threads) => Ok(threads),
        _ => Err(format!("write a whole number from 1 to {MOST_THREADS}")),
    }
}

#[cfg(feature = "parallel")]
fn start(threads: usize) -> Result<(), String> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(|error| error.to_string())
}

#[cfg(not(feature = "parallel"))]
fn start(threads: usize) -> Result<(), String> {
    if threads == 1 { Ok(()) } else { Err("this build works on one thread".to_owned()) }
}

/// For commands that may use a graphics adapter.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct AdapterArgs {
    /// The graphics adapter to use, by a part of its name
    /// [default: the one that the environment variable UMBRAGE_ADAPTER names, else the fastest kind there is]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

impl AdapterArgs {
    /// Opens the adapter that was asked for.
    #[cfg(feature = "gpu")]
    pub(crate) fn open(&self) -> Result<Gpu, Failure> {
        Ok(Gpu::new(self.adapter.as_deref())?)
    }

    /// Whether one was asked for.
    pub(crate) fn was_asked_for(&self) -> bool {
        self.adapter.is_some()
    }

    /// Refuses an adapter, where nothing could use it yet.
    pub(crate) fn refuse(&self) -> Result<(), Failure> {
        match &self.adapter {
            None => Ok(()),
            Some(name) => Err(Failure::not_built(format_args!("--adapter {name}"), "leave it out")),
        }
    }
}
