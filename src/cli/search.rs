//! Techniques that search on a graphics adapter, on samples of the CPU.

use umbrage::shadow::soft::{Search, SingleSampleOptions};
use umbrage::shadow::{Request, Technique, Visibility};

use super::Failure;
use super::resources::AdapterArgs;

/// The adapter, if any technique asks for one.
pub(crate) struct Searcher {
    #[cfg(feature = "gpu")]
    pass: Option<(umbrage::gpu::Gpu, umbrage::shadow::soft::gpu::SearchPass)>,
}

/// The options of a technique that searches on an adapter.
fn on_device(technique: Technique) -> Option<SingleSampleOptions> {
    match technique {
        Technique::SingleSample(options) if options.search == Search::Device => Some(options),
        _ => None,
    }
}

/// Whether the technique needs an adapter.
pub(crate) fn needs_adapter(technique: Technique) -> bool {
    on_device(technique).is_some()
}

/// The same technique on the CPU.
pub(crate) fn on_cpu(technique: Technique) -> Technique {
    let cpu = |options| Technique::SingleSample(SingleSampleOptions { search: Search::Cpu, ..options });
    on_device(technique).map_or(technique, cpu)
}

impl Searcher {
    /// Opens the adapter if one of the techniques needs it.
    pub(crate) fn open(
        adapter: &AdapterArgs,
        techniques: impl IntoIterator<Item = Technique>,
    ) -> Result<Self, Failure> {
        let is_needed = techniques.into_iter().any(needs_adapter);
        #[cfg(feature = "gpu")]
        {
            let open = || {
                let gpu = adapter.open("search=device")?;
                let pass = umbrage::shadow::soft::gpu::SearchPass::new(&gpu)?;
                Ok::<_, Failure>((gpu, pass))
            };
            Ok(Self { pass: if is_needed { Some(open()?) } else { None } })
        }
        #[cfg(not(feature = "gpu"))]
        {
            if is_needed {
                adapter.open("search=device")?;
            }
            Ok(Self {})
        }
    }

    /// Prepares and shades, on the adapter or the CPU.
    pub(crate) fn shade(&self, technique: Technique, request: &Request<'_>) -> Result<Visibility, Failure> {
        #[cfg(feature = "gpu")]
        if let (Some((_, pass)), Some(options)) = (&self.pass, on_device(technique)) {
            return Ok(pass.shade(request, &options)?);
        }
        Ok(technique.shade(request)?)
    }

    /// What computes the technique.
    pub(crate) fn place(&self, technique: Technique) -> String {
        #[cfg(feature = "gpu")]
        if let (Some((gpu, _)), true) = (&self.pass, needs_adapter(technique)) {
            return super::output::plain(&gpu.name());
        }
        let _ = technique;
        "the CPU".to_owned()
    }
}
