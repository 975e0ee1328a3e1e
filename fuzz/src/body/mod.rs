//! What every target does with its bytes. No fuzzer is needed to run it: the tests of the crate replay these.

pub(crate) mod command;
pub(crate) mod meshopt;
mod naive;
pub(crate) mod oracle;
pub(crate) mod polygon;
pub(crate) mod read;
pub(crate) mod shadow;
pub(crate) mod threemf;
pub(crate) mod topology;
mod whole;

/// A target by name: panics where a claim does not hold.
pub(crate) type Body = fn(&[u8]);

/// Every target.
pub(crate) const TARGETS: [(&str, Body); 13] = [
    ("read_obj", |data| read::run(data, "a.obj")),
    ("read_gltf", |data| read::run(data, "a.gltf")),
    ("read_meshopt", meshopt::run),
    ("read_stl", |data| read::run(data, "a.stl")),
    ("read_ply", |data| read::run(data, "a.ply")),
    ("read_off", |data| read::run(data, "a.off")),
    ("read_3mf", threemf::run),
    ("read_md2", |data| read::run(data, "a.md2")),
    ("polygon", polygon::run),
    ("topology", topology::run),
    ("shadow", shadow::run),
    ("oracle", oracle::run),
    ("cli", command::run),
];
