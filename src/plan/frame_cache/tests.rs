//! A cache over a script of single changes, against frames that are made anew.

use super::fault::Fault;
use super::*;
use crate::random::SplitMix64;
use crate::shadow::GridOptions;
use crate::testing::shapes;
use crate::view::{Camera, Up};

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Nothing,
    Camera,
    Lamp,
    Brightness,
    Place,
    Vertices,
    Caster,
    /// Another fineness of the light grid; the same visibility.
    Grid,
}

const CHANGES: [Change; 8] = [
    Change::Nothing,
    Change::Camera,
    Change::Lamp,
    Change::Brightness,
    Change::Place,
    Change::Vertices,
    Change::Caster,
    Change::Grid,
];

struct Script {
    random: SplitMix64,
    /// Each mesh in its frames.
    meshes: Vec<Vec<Mesh>>,
    /// Mesh, frame and transform of each caster.
    casters: Vec<(u32, u32, Mat4)>,
    lamps: Vec<Lamp>,
    eye: [f32; 3],
    grid: u32,
}

impl Script {
    fn new(seed: u64) -> Self {
        let frames = |mesh: Mesh| vec![mesh.clone(), shapes::scaled(&mesh, 1.5), shapes::scaled(&mesh, 0.5)];
        let meshes = [shapes::cube(), shapes::torus(8, 5, 2.0, 0.7), shapes::double_sheet()];
        let at = |x: f32, y: f32| Mat4::from_translation([x, y, 0.0].into());
        let lamp = |text: &str| text.parse().unwrap();
        Self {
            random: SplitMix64(seed),
            meshes: meshes.into_iter().map(frames).collect(),
            casters: vec![
                (0, 0, at(0.0, 3.0)),
                (1, 0, at(1.0, 0.0)),
                (2, 0, at(0.0, -2.0)),
                (0, 0, at(3.0, 1.0)),
            ],
            lamps: vec![lamp("point:3,9,5,range=30"), lamp("directional:0.2,-1,0.1")],
            eye: [9.0, 7.0, 8.0],
            grid: 32,
        }
    }

    fn number(&mut self) -> f32 {
        self.random.below(64) as f32 / 16.0 + 1.0
    }

    fn change(&mut self, change: Change) {
        let [index, lamp] = [self.casters.len(), self.lamps.len()].map(|count| self.random.below(count));
        let by = [self.number(), self.number(), self.number()];
        match change {
            Change::Nothing => {}
            Change::Camera => self.eye = by.map(|x| 3.0 + 2.0 * x),
            Change::Lamp => {
                let [x, y, z] = by;
                self.lamps[lamp] = format!("point:{x},{},{z},range=30", y + 6.0).parse().unwrap();
            }
            Change::Brightness => match self.random.below(3) {
                0 => self.lamps[lamp].intensity = if self.lamps[lamp].intensity == 0.0 { by[0] } else { 0.0 },
                1 => self.lamps[lamp].intensity = by[0],
                _ => self.lamps[lamp].range = Some(by[0] * 3.0),
            },
            Change::Place => {
                self.casters[index].2 = Mat4::from_translation(by.into()) * Mat4::from_rotation_y(by[1]);
            }
            Change::Vertices => self.casters[index].1 = (self.casters[index].1 + 1) % 3,
            Change::Grid => self.grid = 80 - self.grid,
            Change::Caster if self.casters.len() > 3 => drop(self.casters.remove(index)),
            Change::Caster => self.casters.push((1, 2, Mat4::from_translation(by.into()))),
        }
    }

    /// The frame, by the cache and by a new one: whether they are the same, and what was made.
    fn step(&self, cache: &mut FrameCache) -> (bool, Made) {
        let casters: Vec<Posed<'_>> = (self.casters.iter())
            .map(|&(mesh, frame, world_from_mesh)| Posed {
                mesh,
                frame,
                shape: &self.meshes[mesh as usize][frame as usize],
                world_from_mesh,
            })
            .collect();
        let size = Size::new(20, 15).unwrap();
        let camera = Camera::look_at(self.eye, [0.0; 3], 0.8, Up::Y).unwrap();
        let moment = Moment {
            casters: &casters,
            lamps: &self.lamps,
            volumes: true,
            view: Some((camera.projection(size, 0.1), size)),
            technique: Technique::Hybrid(GridOptions { grid: self.grid }),
            physical_falloff: true,
        };
        let mut cold = FrameCache::default();
        let anew = cold.frame(&moment).unwrap();
        let kept = cache.frame(&moment).unwrap();
        let is_same = are_same(&kept, &anew);
        (is_same, cache.made())
    }
}

fn are_same(a: &Frame<'_>, b: &Frame<'_>) -> bool {
    let bits = |volume: &ShadowVolume| -> (Vec<[u32; 4]>, Vec<[u32; 3]>) {
        (volume.to_f32().into_iter().map(|v| v.map(f32::to_bits)).collect(), volume.triangles().to_vec())
    };
    let positions = |frame: &Frame<'_>| -> Vec<Vec<[u32; 3]>> {
        let of = |caster: &&Caster| caster.mesh().positions().iter().map(|p| p.map(f32::to_bits)).collect();
        frame.casters.iter().map(of).collect()
    };
    positions(a) == positions(b)
        && a.volumes.len() == b.volumes.len()
        && a.volumes.iter().zip(&b.volumes).all(|(a, b)| bits(a) == bits(b))
        && a.samples.map(Samples::hits) == b.samples.map(Samples::hits)
        && a.grids == b.grids
        && a.relevances == b.relevances
        && a.visibilities == b.visibilities
}

/// Changes of all kinds, in an order that no kind dominates.
fn script(cache: &mut FrameCache, steps: usize) -> Vec<(Change, bool, Made, [usize; 2])> {
    let mut script = Script::new(5);
    script.step(cache);
    let step = |number: usize| {
        let change = match number {
            0..8 => CHANGES[number],
            _ => CHANGES[script.random.below(CHANGES.len())],
        };
        script.change(change);
        let (is_same, made) = script.step(cache);
        (change, is_same, made, [script.casters.len(), script.lamps.len()])
    };
    (0..steps).map(step).collect()
}

#[test]
fn cached_frames_have_the_bytes_of_new_ones_and_only_what_moved_is_made() {
    for (number, (change, is_same, made, [casters, lamps])) in
        script(&mut FrameCache::default(), 200).into_iter().enumerate()
    {
        assert!(is_same, "step {number}: {change:?}");
        let Made { topologies, casters: posed, volumes, trees, samples, grids, relevances, visibilities } =
            made;
        let counts = [posed, volumes, trees, samples, grids, relevances, visibilities];
        // The table at the head of the module. A change may by chance lead to what was there before.
        let most = match change {
            Change::Nothing => [0; 7],
            Change::Camera => [0, 0, 0, 1, 0, lamps, lamps],
            Change::Lamp => [0, casters, 0, 0, 1, 1, 1],
            Change::Brightness => [0, 0, 0, 0, 0, 1, 0],
            Change::Grid => [0, 0, 0, 0, lamps, 0, lamps],
            Change::Place | Change::Vertices | Change::Caster => [1, lamps, 1, 1, lamps, lamps, lamps],
        };
        assert!(counts.iter().zip(most).all(|(made, most)| *made <= most), "{change:?}: {made:?}");
        assert!(topologies <= usize::from(change == Change::Caster), "{change:?}: {made:?}");
    }
}

#[test]
fn cached_frames_whose_keys_forget_a_part_are_not() {
    for fault in [
        Fault::Frame,
        Fault::Place,
        Fault::Light,
        Fault::View,
        Fault::Casters,
        Fault::Brightness,
        Fault::GridCasters,
        Fault::GridLight,
        Fault::GridSide,
    ] {
        let mut cache = FrameCache { faults: Faults(Some(fault)), ..FrameCache::default() };
        let is_found = script(&mut cache, 60).iter().any(|(_, is_same, ..)| !is_same);
        assert!(is_found, "{fault:?}");
    }
}

#[test]
fn cached_frames_survive_an_error_and_forget_what_is_not_used() {
    let (mut cache, script) = (FrameCache::default(), Script::new(7));
    assert!(script.step(&mut cache).0);
    let cube = shapes::cube();
    let far =
        Posed { mesh: 9, frame: 0, shape: &cube, world_from_mesh: Mat4::from_scale([f32::MAX; 3].into()) };
    let stretched = shapes::scaled(&cube, 8.0);
    let far = Posed { shape: &stretched, ..far };
    let moment = Moment {
        casters: &[far],
        lamps: &script.lamps,
        volumes: true,
        view: None,
        technique: Technique::Rays,
        physical_falloff: false,
    };
    let error = cache.frame(&moment).unwrap_err().to_string();
    assert!(error.starts_with("caster 0: ") && error.ends_with("; move it nearer to the origin"), "{error}");
    assert!(script.step(&mut cache).0);
    let empty = Moment { casters: &[], lamps: &[], volumes: false, ..moment };
    assert!(cache.frame(&empty).unwrap().volumes.is_empty());
    assert!(cache.casters.is_empty() && cache.volumes.is_empty() && cache.rests.is_empty());
    assert!(cache.tree.is_none() && cache.samples.is_none() && cache.visibilities.is_empty());
}
