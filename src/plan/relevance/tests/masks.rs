//! Stencil masks with all pieces, and with those that a plane does not part from the view: the same bytes.

use super::super::{Pieces, Question, RelevanceTest, TestSet, casting, relevant};
use super::families::{Family, families};
use crate::caster::{Caster, CasterGroup, GpuCaster};
use crate::facing::CasterFaces;
use crate::gpu::Gpu;
use crate::gpu::tests::gpu;
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::stencil::{Counting, Draw, StencilMethod, StencilPass};
use crate::shadow::volume::{Caps, GpuVolume};
use crate::shadow::{Depth, Samples};
use crate::view::{Projection, Size};

/// The counts of a picture.
fn mask(
    gpu: &Gpu,
    pass: &StencilPass,
    view: (&Projection, Size),
    receivers: &GpuCaster,
    casters: &[&Caster],
    lamp: &Lamp,
) -> Vec<i32> {
    let volumes: Vec<GpuVolume> = casters
        .iter()
        .map(|caster| {
            let faces = caster.shell_faces(lamp.light(), Some(CasterFaces::All));
            let volume = caster.volume_of(lamp.light(), &faces, Caps::Both);
            GpuVolume::upload(gpu, &volume).unwrap()
        })
        .collect();
    let draws: Vec<Draw<'_>> =
        volumes.iter().map(|volume| Draw { volume, method: StencilMethod::ZFail }).collect();
    let (projection, size) = view;
    pass.mask(projection, size, receivers, &draws, Counting::Integer).unwrap().raw().to_vec()
}

/// Compares the masks of a family's views under one of its lamps: pixels that differ, pieces dropped, and
/// pixels in shadow.
fn compare(gpu: &Gpu, pass: &StencilPass, family: &Family, lamp: &Lamp) -> [usize; 3] {
    let casters: Vec<Caster> = family.casters.iter().cloned().map(Caster::new).collect();
    let group = CasterGroup::new(casters.iter().collect());
    let pieces = Pieces::of(&group);
    let seen = Caster::new(Mesh::concat(&family.casters).unwrap());
    let receivers = GpuCaster::upload(gpu, &seen).unwrap();
    let mut found = [0; 3];
    for (projection, size) in family.projections() {
        if projection.is_orthographic() {
            continue; // no stencil pass draws it
        }
        let samples = Samples::of_view(&group, &projection, size, 1).unwrap();
        let relevance = relevant(&Question {
            casters: &group,
            pieces: &pieces,
            lamp,
            number: 0,
            samples: &samples,
            physical_falloff: false,
            level: 0.0,
            tests: TestSet::only(RelevanceTest::Parted),
        });
        let all = mask(gpu, pass, (&projection, size), &receivers, group.casters(), lamp);
        let kept = casting(&group, &pieces, &relevance.kept).unwrap_or_default();
        if relevance.kept.len() < pieces.len() {
            let kept: Vec<&Caster> = kept.iter().collect();
            let with = mask(gpu, pass, (&projection, size), &receivers, &kept, lamp);
            found[0] += all.iter().zip(&with).filter(|(a, b)| a != b).count();
        }
        found[1] += pieces.len() - relevance.kept.len();
        found[2] += all.iter().filter(|&&count| count != 0).count();
    }
    found
}

#[test]
fn masks_without_what_is_parted_from_the_view_are_the_same_bytes() {
    let Some(gpu) = gpu() else { return };
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    let mut sum = [0; 3];
    for family in families(1).into_iter().filter(|family| ["street", "sheets"].contains(&family.name)) {
        for lamp in [0, 1] {
            let found = compare(&gpu, &pass, &family, &family.lamps[lamp]);
            assert_eq!(found[0], 0, "{} under lamp {lamp}", family.name);
            sum = [0, 1, 2].map(|i| sum[i] + found[i]);
        }
    }
    assert!(sum[1] > 20 && sum[2] > 500, "{sum:?}");
}
