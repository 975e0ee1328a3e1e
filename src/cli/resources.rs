//! What the machine may be asked for: threads, a graphics adapter.

use std::fmt;

#[cfg(feature = "gpu")]
use umbrage::gpu::{Gpu, GpuError};

use super::error::Failure;
use super::output::say;

/// For commands that may be long.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
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

    /// The same with one thread where nothing was said.
    pub(crate) fn apply_or_one(self) -> Result<(), Failure> {
        Self { threads: self.threads.or(Some(1)) }.apply()
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
    ///
    /// [default: the one that the environment variable UMBRAGE_ADAPTER names, else the fastest kind there is]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
}

impl AdapterArgs {
    /// Whether one was asked for.
    pub(crate) fn was_asked_for(&self) -> bool {
        self.adapter.is_some()
    }

    /// Says that an adapter was named which nothing uses, and why.
    pub(crate) fn unused(&self, why: impl fmt::Display) {
        if let Some(name) = &self.adapter {
            say(format_args!("note: --adapter {name} is not used: {why}"));
        }
    }

    /// Opens the adapter for `asker`, the option that needs one.
    #[cfg(feature = "gpu")]
    pub(crate) fn open(&self, _asker: &str) -> Result<Gpu, Failure> {
        Ok(Gpu::new(self.adapter.as_deref())?)
    }

    /// Opens the adapter if there is one; says why not. One that is asked for by name must be there.
    #[cfg(feature = "gpu")]
    pub(crate) fn find(&self) -> Result<Result<Gpu, GpuError>, Failure> {
        match Gpu::new(self.adapter.as_deref()) {
            Err(error) if self.adapter.is_some() || matches!(error, GpuError::NoSuchAdapter { .. }) => {
                Err(error.into())
            }
            found => Ok(found),
        }
    }

    /// Refuses `asker`, the option that needs an adapter.
    #[cfg(not(feature = "gpu"))]
    pub(crate) fn open(&self, asker: &str) -> Result<std::convert::Infallible, Failure> {
        let problem = format!("{asker}: this build has no graphics");
        Err(Failure::new(problem, "leave it out, or build with the feature gpu"))
    }

    /// Refuses an adapter that nothing could use.
    #[cfg(not(feature = "gpu"))]
    pub(crate) fn refuse(&self) -> Result<(), Failure> {
        match &self.adapter {
            None => Ok(()),
            Some(name) => self.open(&format!("--adapter {name}")).map(|_| ()),
        }
    }
}
