//! The file that is written.

use std::io;

use umbrage::write::{
    self, Form, Model, Occlusion, Target, Written, glb_with_occlusion, with_occlusion, write_atomic,
};

use super::compute::Values;
use super::input::Input;
use super::{Args, note};
use crate::cli::{Failure, output};

pub(super) fn save(args: &Args, target: Target, input: &Input, values: &Values) -> Result<(), Failure> {
    let bent = values.ambient.bent.as_deref().filter(|_| args.bent);
    let occlusion = Occlusion { corners: &values.corners, openness: &values.ambient.openness, bent };
    if target == Target::Ply {
        write::write(&Model { layers: with_occlusion(&input.meshes, &occlusion) }, &args.output)?;
    } else {
        let written = match &input.gltf {
            Some(gltf) => gltf.file.with_occlusion(Some(&gltf.kept), &occlusion, &gltf.options),
            None => glb_with_occlusion(&input.meshes, &occlusion, args.form()),
        };
        let Written { bytes, notes } = written.map_err(|error| Failure::from(error).in_file(&args.file))?;
        notes.iter().for_each(|text| note(args, output::plain(text)));
        write_atomic(&args.output, |out| -> io::Result<()> { out.write_all(&bytes) })?;
        if args.form() == Form::Color {
            output::say("note: --as color: viewers darken direct light too, not only that of the sky");
        }
    }
    output::wrote(&args.output);
    Ok(())
}
