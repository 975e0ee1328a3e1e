//! Soft shadows of a device beside those of the CPU on the same map.

use super::search::receiver;
use super::*;
use crate::caster::{Caster, CasterGroup, GpuCaster};
use crate::gpu::tests::gpu;
use crate::mesh::Mesh;
use crate::oracle::PrimaryHit;
use crate::shadow::map::gpu::MapPass;
use crate::shadow::map::{LightSpace, ShadowMap};
use crate::shadow::soft::around::{Around, Found};
use crate::shadow::soft::light_map::{LightMap, profile};
use crate::shadow::soft::pyramid::Pyramid;
use crate::shadow::soft::{PcssOptions, Search, SingleSampleOptions, Taps, above_horizon};
use crate::shadow::{
    Answer, Claim, Depth, GpuSamples, Request, Samples, Technique, Visibility, is_front_lit,
};
use crate::testing::shapes;
use crate::view::{Camera, Size, Up};

/// A sun, a spot of one layer, and two lamps with a cube: a rectangle, and a sphere within the scene.
const LAMPS: [&str; 4] = [
    "directional:0.3,0.2,-1,angle=12",
    "spot:1,2,9:-0.1,-0.2,-1:35,radius=0.6",
    "rect:-1,-0.5,6:2,0.1,0:0,1,0.5",
    "point:0,0.2,1,radius=0.3",
];

fn scenes() -> [Caster; 2] {
    let sheet = shapes::translated(&shapes::scaled(&shapes::sheet(3), 2.5), [-3.75, -3.75, -1.5]);
    let knot = Mesh::concat(&[shapes::torus_knot(2, 3, 40, 7, 0.4), sheet.clone()]).unwrap();
    let cube = shapes::translated(&shapes::cube(), [1.5, -1.0, 2.0]);
    let ring = Mesh::concat(&[shapes::torus(20, 10, 2.0, 0.5), cube, sheet]).unwrap();
    [Caster::new(knot), Caster::new(ring)]
}

/// A map on the device, and the same texels on the CPU.
struct Twins<'a> {
    gpu: &'a Gpu,
    lamp: Lamp,
    samples: Samples,
    drawn: GpuSamples,
    map: GpuMap,
    on_cpu: LightMap<'a>,
}

impl<'a> Twins<'a> {
    fn new(gpu: &'a Gpu, casters: &'a CasterGroup<'a>, lamp: &str, side: u32) -> Self {
        let lamp: Lamp = lamp.parse().unwrap();
        let size = Size::new(64, 48).unwrap();
        let projection = Camera::fit(&casters.bounds(), Up::Z, size.aspect()).projection(size, 0.125);
        let samples = Samples::of_view(casters, &projection, size, 1).unwrap();
        let on_device = GpuCaster::upload(gpu, casters.casters()[0]).unwrap();
        let drawn = on_device.samples(&projection, size, Depth::Plane).unwrap();
        let space = LightSpace::of_scene(casters, &lamp, side).unwrap();
        let map = MapPass::new(gpu).unwrap().draw(&on_device, &space).unwrap();
        let texels = (0..space.layers()).flat_map(|layer| map.download(gpu, layer).unwrap()).collect();
        let texels = ShadowMap::of_texels(space, texels);
        let pyramid = Pyramid::of(&texels);
        let on_cpu = LightMap { casters, lamp: lamp.clone(), map: texels, pyramid };
        Self { gpu, lamp, samples, drawn, map, on_cpu }
    }

    /// Samples that face the lamp.
    fn front_lit(&self) -> Vec<usize> {
        let is_lit = |index: &usize| {
            self.samples.hits()[*index].as_ref().is_some_and(|hit| is_front_lit(hit, self.lamp.light()))
        };
        (0..self.samples.len()).filter(is_lit).collect()
    }

    /// The share of the lamp above the plane of each sample's face.
    fn above(&self) -> Visibility {
        let lit = |_: &PrimaryHit| Answer::of(1.0);
        let mut above = Visibility::of(&self.samples, self.lamp.light(), Claim::Approximate, lit);
        above_horizon(&mut above, &self.samples, &self.lamp);
        above
    }
}

#[test]
fn pyramid_on_a_device_is_that_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let [caster, _] = scenes();
    let casters = CasterGroup::new(vec![&caster]);
    for (lamp, side) in [(LAMPS[0], 100), (LAMPS[3], 64), (LAMPS[1], 8), (LAMPS[0], 5)] {
        let twins = Twins::new(&gpu, &casters, lamp, side);
        let soft = SoftPass::new(&gpu).unwrap().prepare(&twins.map, &twins.lamp).unwrap();
        let cells: Vec<[f32; 2]> = gpu.download(&soft.pyramid, soft.cells).unwrap();
        let (pyramid, layers) = (&twins.on_cpu.pyramid, twins.map.space().layers());
        let tiles = pyramid.side();
        for (index, cell) in cells[..layers * tiles * tiles].iter().enumerate() {
            let (i, j) = (index % tiles, index / tiles % tiles);
            assert_eq!(*cell, pyramid.tile(index / (tiles * tiles), i, j), "{lamp} {index}");
        }
        let tops = &cells[cells.len() - layers..];
        assert_eq!(tops.iter().fold(0.0, |most: f32, top| most.max(top[1])), pyramid.most_drawn());
        assert!(pyramid.most_drawn() > 0.0);
    }
}

/// Searches on the device that found something else than on the CPU around the same receivers; all; and those
/// in penumbrae.
fn search_twins(twins: &Twins<'_>, pass: &SearchPass) -> [usize; 3] {
    let soft = pass.prepare(&twins.map, &twins.lamp).unwrap();
    let count = twins.samples.len();
    let placed = pass.place(&twins.drawn, &twins.map, &soft).unwrap();
    // Receivers of the device, and those of the CPU.
    let of_device: Vec<Around> = twins.gpu.download(&placed, count).unwrap();
    let on_cpu = (twins.samples.hits().iter())
        .map(|hit| hit.as_ref().and_then(|hit| receiver(twins.map.space(), &twins.lamp, hit)));
    let all: Vec<Around> = of_device.into_iter().chain(on_cpu.map(Option::unwrap_or_default)).collect();
    let receivers = twins.gpu.upload("receivers", &all).unwrap();
    let found = pass.search(&receivers, all.len(), &twins.map, &soft).unwrap();
    let found: Vec<Found> = twins.gpu.download(&found, all.len()).unwrap();
    let [mut differ, mut there, mut inside] = [0; 3];
    for (around, found) in all.iter().zip(found) {
        let own = match around.is_there {
            0 => Found::OPEN,
            _ => twins.on_cpu.change_around(*around).unwrap().0,
        };
        differ += usize::from(own != found);
        there += usize::from(around.is_there == 1);
        inside += usize::from(own.distance() < 1.0);
    }
    [differ, there, inside]
}

#[test]
fn search_on_a_device_equals_that_of_the_cpu_bit_by_bit() {
    let Some(gpu) = gpu() else { return };
    let [knot, ring] = scenes();
    let pass = SearchPass::new(&gpu).unwrap();
    let faults = [
        // The receiver's depth instead of its plane.
        ("width = width_of(here, depth - plane)", "width = width_of(here, depth - here.depth)"),
        // Rows that run upwards.
        ("+ here.slope.y * f32(offset.y)", "- here.slope.y * f32(offset.y)"),
        // The first change instead of the darkest one.
        ("if order < 0 ||", "if (*search).best.y == 1u || order > 2 ||"),
    ];
    let faulty = faults.map(|(text, fault)| SearchPass::with_fault(&gpu, text, fault));
    for (caster, lamp, side) in [
        (&knot, LAMPS[0], 256),
        (&ring, LAMPS[1], 200),
        (&ring, LAMPS[2], 128),
        (&knot, LAMPS[3], 96), // no power of two, and across seams
    ] {
        let casters = CasterGroup::new(vec![caster]);
        let twins = Twins::new(&gpu, &casters, lamp, side);
        let [differ, there, inside] = search_twins(&twins, &pass);
        assert!(differ == 0 && there > 1000 && inside > 60, "{lamp} {differ} {there} {inside}");
        if lamp == LAMPS[0] {
            for (faulty, (_, fault)) in faulty.iter().zip(faults) {
                let [differ, ..] = search_twins(&twins, faulty);
                assert!(differ > 5, "{lamp} {fault}: {differ}");
            }
        }
    }
}

/// The texture has the value of what was found, in half precision; so has the technique on samples of the
/// CPU.
#[test]
fn single_sample_on_a_device_has_the_values_of_its_search() {
    let Some(gpu) = gpu() else { return };
    let [knot, ring] = scenes();
    let pass = SearchPass::new(&gpu).unwrap();
    for (caster, lamp) in [(&knot, LAMPS[0]), (&ring, LAMPS[1]), (&ring, LAMPS[2])] {
        let casters = CasterGroup::new(vec![caster]);
        let twins = Twins::new(&gpu, &casters, lamp, 128);
        let soft = pass.prepare(&twins.map, &twins.lamp).unwrap();
        let values = pass.visibility(&twins.drawn, &twins.map, &soft).unwrap().download(&gpu).unwrap();
        let placed = pass.place(&twins.drawn, &twins.map, &soft).unwrap();
        let found = pass.search(&placed, values.len(), &twins.map, &soft).unwrap();
        let found: Vec<Found> = gpu.download(&found, values.len()).unwrap();
        let is_round = twins.lamp.patch([0.0; 3]).unwrap().is_round;
        let lit = twins.front_lit();
        let above = twins.above();
        for &index in &lit {
            let distance = found[index].distance();
            let value = profile(is_round, if found[index].is_inner == 1 { -distance } else { distance });
            let value = (value as f32).min(above.values()[index]);
            let off = (value - values[index]).abs();
            assert!(off < TOLERANCE, "{lamp} {index} {value} {}", values[index]);
        }
        // On the same samples: other points where a pixel's face differs, other maps at edges.
        let request = Request { casters: &casters, lamp: &twins.lamp, samples: &twins.samples };
        let options = SingleSampleOptions { size: 128, ..SingleSampleOptions::DEFAULT };
        let cpu = Technique::SingleSample(options).shade(&request).unwrap();
        let device =
            pass.shade(&request, &SingleSampleOptions { search: Search::Device, ..options }).unwrap();
        assert_eq!(cpu.asked(), device.asked());
        for shown in [device.values(), &values] {
            let off = lit.iter().filter(|&&index| (cpu.values()[index] - shown[index]).abs() > 1.0 / 256.0);
            let off = off.count();
            assert!(off * 25 < lit.len(), "{lamp} {off} of {}", lit.len());
        }
        for refused in
            [SingleSampleOptions { adaptive: 2, ..options }, SingleSampleOptions { literal: true, ..options }]
        {
            assert!(matches!(pass.shade(&request, &refused), Err(GpuError::NotBuilt(_))));
        }
    }
}

/// The arc sine of Mesa's software driver leaves the range of shares in the penumbra of this lamp, unless the
/// value is cut.
#[test]
fn single_sample_on_a_device_is_a_share_whatever_the_arc_sine() {
    let Some(gpu) = gpu() else { return };
    let pass = SearchPass::new(&gpu).unwrap();
    for caster in &scenes() {
        let casters = CasterGroup::new(vec![caster]);
        let twins = Twins::new(&gpu, &casters, "point:2,1,9,radius=2", 128);
        let soft = pass.prepare(&twins.map, &twins.lamp).unwrap();
        let values = pass.visibility(&twins.drawn, &twins.map, &soft).unwrap().download(&gpu).unwrap();
        assert!(values.iter().all(|value| (0.0..=1.0).contains(value)), "{values:?}");
        assert!(values.iter().any(|&value| value > 0.0 && value < 1.0));
    }
}

/// Front-lit samples whose value on the device is not that of the CPU on the same map, and all.
fn pcss_twins(twins: &Twins<'_>, pass: &PcssPass, options: PcssOptions) -> [usize; 3] {
    let soft = pass.prepare(&twins.map, &twins.lamp).unwrap();
    let values = pass.visibility(&twins.drawn, &twins.map, &soft, &options).unwrap();
    let values = values.download(twins.gpu).unwrap();
    let light = twins.lamp.light();
    let mut cpu = Visibility::of(&twins.samples, light, Claim::Approximate, |hit| {
        twins.on_cpu.answer(hit, |receiver| receiver.filtered(options.blockers, options.taps))
    });
    above_horizon(&mut cpu, &twins.samples, &twins.lamp);
    let lit = twins.front_lit();
    let differ = lit.iter().filter(|&&index| (values[index] - cpu.values()[index]).abs() > TOLERANCE);
    let inside = lit.iter().filter(|&&index| cpu.values()[index] > 0.0 && cpu.values()[index] < 1.0);
    [differ.count(), lit.len(), inside.count()]
}

/// Half precision below 1 rounds by 2⁻¹², and an arc sine or cosine on a device errs by some 2⁻¹¹.
const TOLERANCE: f32 = 1.0 / 512.0;

/// Of a decision per texel, and the same decisions, both twins make the same value: k/16 of 16 points is a
/// half without rounding, areas of all texels add up to 2⁻¹¹. Decisions differ where a point lies within
/// rounding of a texel's border: a position on a map of 128 texels has an error of some 2⁻¹⁶ texels, so that
/// of 32 points with two coordinates one in 1000 samples has another texel, and where a depth is within 2⁻²⁰
/// of the receiver's plane. A pixel at the edge of two faces may show the other one. One in 100 is the limit.
#[test]
fn pcss_on_a_device_equals_that_of_the_cpu_but_for_ties() {
    let Some(gpu) = gpu() else { return };
    let [knot, ring] = scenes();
    let pass = PcssPass::new(&gpu).unwrap();
    let faults = [
        // Half the width.
        ("half = max(here.k * (blockers.depth", "half = max(0.5 * here.k * (blockers.depth"),
        // Points of another noise.
        ("vec2f(noise(part.x, part.y)", "vec2f(noise(part.y, part.x)"),
        // Rows that run upwards.
        ("vec2f(receiver.plane.x, -receiver.plane.y)", "vec2f(receiver.plane.x, receiver.plane.y)"),
    ];
    let faulty = faults.map(|(text, fault)| PcssPass::with_fault(&gpu, text, fault));
    let few = PcssOptions { size: 128, ..PcssOptions::DEFAULT };
    let all = PcssOptions { blockers: Taps::All, taps: Taps::All, ..few };
    for (caster, lamp) in [(&knot, LAMPS[0]), (&ring, LAMPS[1]), (&ring, LAMPS[2]), (&knot, LAMPS[3])] {
        let casters = CasterGroup::new(vec![caster]);
        let twins = Twins::new(&gpu, &casters, lamp, few.size);
        // All texels of a wide penumbra are many: two lamps suffice.
        let with_all = [LAMPS[0], LAMPS[2]].contains(&lamp);
        for options in [few, all].into_iter().take(1 + usize::from(with_all)) {
            let [differ, lit, inside] = pcss_twins(&twins, &pass, options);
            assert!(
                differ * 100 < lit && lit > 400 && inside > 60,
                "{lamp} {options:?} {differ} {lit} {inside}"
            );
        }
        if lamp == LAMPS[2] {
            for (faulty, (_, fault)) in faulty.iter().zip(faults) {
                let [differ, lit, _] = pcss_twins(&twins, faulty, few);
                assert!(differ * 100 > lit, "{lamp} {fault}: {differ} of {lit}");
            }
        }
    }
}

/// Walls that the plane of each lamp's middle nearly touches: a part of every lamp is below the horizon. No
/// texel tells this. A pixel at the edge of two faces may show the other one.
#[test]
fn soft_values_on_a_device_end_at_the_horizon_as_on_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let walls = |turn: [usize; 3]| {
        // A wall that leans to one side, and its mirror image, along two of the axes.
        let wall = |sign: f32| {
            let sheet = shapes::sheet(3);
            let leaning = |&[x, y, _]: &[f32; 3]| {
                let p = [sign * (1.0 + 0.05 * (y - 1.5)), x - 1.5, y - 1.5];
                turn.map(|axis| p[axis])
            };
            Mesh::new(sheet.positions().iter().map(leaning).collect(), sheet.triangles().to_vec()).unwrap()
        };
        Caster::new(Mesh::concat(&[wall(1.0), wall(-1.0)]).unwrap())
    };
    let (pcss, search) = (PcssPass::new(&gpu).unwrap(), SearchPass::new(&gpu).unwrap());
    let options = PcssOptions { size: 64, ..PcssOptions::DEFAULT };
    let faults = [
        ("return (acos(x) - x", "return (acos(x) + x", [0, 1, 3]),
        ("/ long * (depth / short) / 8.0", "/ long * (depth / short) / 4.0", [2, 2, 2]),
        ("{ toward -= receiver.corner; }", "{ toward += receiver.corner; }", [1, 2, 3]),
    ];
    let faulty = faults.map(|(text, fault, _)| PcssPass::with_fault(&gpu, text, fault));
    for turn in [[0, 1, 2], [1, 0, 2]] {
        let caster = walls(turn);
        let casters = CasterGroup::new(vec![&caster]);
        for (number, lamp) in [
            "directional:0.02,0.01,-1,angle=8",
            "spot:-1.2,1.2,9:0.1,-0.1,-1:60,radius=2",
            "rect:-2.3,-0.9,7.5:2,0,0.5:0.2,4,0.5",
            "point:-1,1,6,radius=1.5",
        ]
        .into_iter()
        .enumerate()
        {
            let twins = Twins::new(&gpu, &casters, lamp, options.size);
            let (lit, above) = (twins.front_lit(), twins.above());
            let cut = |&&index: &&usize| (0.01..0.99).contains(&above.values()[index]);
            let partly = lit.iter().filter(cut).count();
            assert!(partly * 4 > lit.len() && partly > 100, "{lamp} {partly} of {}", lit.len());
            let soft = pcss.prepare(&twins.map, &twins.lamp).unwrap();
            let beyond = |values: &[f32]| {
                lit.iter().filter(|&&index| values[index] > above.values()[index] + TOLERANCE).count()
            };
            let by = |pass: &PcssPass| {
                let values = pass.visibility(&twins.drawn, &twins.map, &soft, &options).unwrap();
                values.download(&gpu).unwrap()
            };
            let values = by(&pcss);
            let [differ, ..] = pcss_twins(&twins, &pcss, options);
            assert!(differ * 50 < lit.len(), "{lamp} {differ} of {}", lit.len());
            let searched = search.visibility(&twins.drawn, &twins.map, &soft).unwrap();
            let searched = searched.download(&gpu).unwrap();
            for values in [&values, &searched] {
                assert!(beyond(values) * 50 < lit.len(), "{lamp} {} of {}", beyond(values), lit.len());
            }
            for (faulty, (_, fault, lamps)) in faulty.iter().zip(faults) {
                if lamps.contains(&number) {
                    let [differ, ..] = pcss_twins(&twins, faulty, options);
                    assert!(differ * 20 > lit.len(), "{lamp} {fault} {differ} of {}", lit.len());
                }
            }
        }
    }
}
