//! Frame times at 512 × 512 pixels on a graphics adapter, which the rows name: the cost of shadows, and the
//! silhouette's part of this cost.

use std::cell::RefCell;

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::geom::{Aabb, Facing, Light};
use umbrage::glam::Vec3;
use umbrage::gpu::{Gpu, wgpu};
use umbrage::mesh::Mesh;
use umbrage::shadow::Depth;
use umbrage::shadow::stencil::{Counting, Draw, ShadowMask, StencilMethod, StencilPass};
use umbrage::shadow::volume::{Caps, GpuExtrusion, GpuVolume, ShadowVolume, VolumeShaders};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;
use umbrage::topology::{GpuTopology, GpuTopologyBuilder, Topology};
use umbrage::verify::pixels::{PixelVerdict, Rendered, compare};
use umbrage::view::{Camera, Projection, Size, Up};

use crate::canvas::Canvas;
use crate::gpu::{submit, wait};
use crate::head;
use crate::measure::{Bench, Contender, Group, Target, timed};
use crate::plot::Curve;

const SIDE: u32 = 512;

/// Segments of torus knots of 364 to 200,000 triangles.
const KNOTS: [[u32; 2]; 7] = [[26, 7], [50, 10], [150, 10], [250, 20], [500, 30], [1000, 50], [1250, 80]];

/// Number of positions through which the light moves, in a cycle.
const PLACES: u16 = 8;

/// Source of a frame's silhouette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    NoShadows,
    Cpu,
    Gpu,
}

const KINDS: [(Kind, &str); 3] =
    [(Kind::NoShadows, "no shadows"), (Kind::Cpu, "CPU silhouettes"), (Kind::Gpu, "GPU silhouettes")];

/// The measured frame rates, on the adapter of this name.
pub(crate) struct Frames {
    pub(crate) adapter: String,
    pub(crate) curves: Vec<Curve>,
}

/// Measures all frames. `None` if the filter excludes them, or if there is no adapter.
pub(crate) fn run(bench: &mut Bench<'_>) -> Option<Frames> {
    let parts = ["frames", "frames of one volume", "frames prepared"].map(|part| bench.wants(part));
    if parts == [false; 3] {
        return None;
    }
    let gpu = match Gpu::new(None) {
        Ok(gpu) => gpu,
        Err(error) => {
            eprintln!("SKIPPED, stage frames: {error}");
            return None;
        }
    };
    let [of_each_kind, of_one_volume, prepared] = parts;
    let knots = if bench.quick { &KNOTS[..2] } else { &KNOTS };
    let knot = |[segments, ring]: [u32; 2]| shapes::torus_knot(2, 3, segments, ring, 0.3);
    let frames = of_each_kind.then(|| {
        let mut curves = KINDS.map(|(_, name)| Curve { name: name.to_owned(), points: Vec::new() });
        let pass = StencilPass::new(&gpu, Depth::Plane).expect("it compiles");
        for mesh in knots.iter().copied().map(knot) {
            let first = bench.rows.len();
            Stage::new(&pass, &mesh).frames(bench);
            for (curve, row) in curves.iter_mut().zip(&bench.rows[first..]) {
                curve.points.push([mesh.face_count() as f64, 1e9 / row.median]);
            }
        }
        Frames { adapter: gpu.name(), curves: curves.into() }
    });
    if of_one_volume {
        one_volume(bench, &gpu);
    }
    if prepared {
        preparation(bench, &gpu, &knot(knots[knots.len() - 1]));
    }
    frames
}

/// A mesh, a camera that sees all of the mesh, and everything prepared before the first frame.
struct Stage<'a> {
    pass: &'a StencilPass,
    caster: Caster,
    view: View,
    facing: RefCell<Vec<Facing>>,
    receivers: GpuCaster,
    extrusion: GpuExtrusion,
    canvas: Canvas<'a>,
}

impl<'a> Stage<'a> {
    fn new(pass: &'a StencilPass, mesh: &Mesh) -> Self {
        let gpu = pass.gpu();
        let prepared = Caster::new(mesh.clone());
        let receivers = GpuCaster::upload(gpu, &prepared).expect("it fits");
        let volumes = VolumeShaders::new(gpu).expect("they compile");
        let extrusion = GpuExtrusion::new(&volumes, &receivers, Caps::Both, None).expect("it fits");
        Self {
            pass,
            view: View::of(mesh),
            facing: RefCell::default(),
            receivers,
            caster: prepared,
            extrusion,
            canvas: Canvas::new(gpu, SIDE),
        }
    }

    /// The three kinds of frame. Each kind's picture is checked after its frames are timed.
    fn frames(&self, bench: &mut Bench<'_>) {
        let gpu = self.pass.gpu();
        let lights: Vec<Light> = (0..PLACES).map(|i| self.view.light(0.01 * f32::from(i))).collect();
        let masks: Vec<ShadowMask> = lights.iter().map(|light| self.exact(light).1).collect();
        let accuracy = self.accuracy(&lights[0], &masks[0]);
        let contenders = KINDS.map(|(kind, name)| {
            let pictures: Vec<Vec<u8>> = lights.iter().map(|light| self.picture(kind, light)).collect();
            let differing = |picture: &Vec<u8>, mask: &ShadowMask| {
                picture.iter().zip(mask.raw()).filter(|(a, b)| i32::from(**a) != **b).count()
            };
            let off: usize = pictures.iter().zip(&masks).map(|(a, b)| differing(a, b)).sum();
            let answer = match kind {
                Kind::NoShadows => {
                    let sky = |&(x, y): &(u32, u32)| masks[0].count(x, y).is_none();
                    assert_eq!(self.canvas.sky(), pixels().filter(sky).count(), "another depth");
                    format!("sky={}", self.canvas.sky())
                }
                Kind::Cpu => {
                    assert_eq!(off, 0, "pixels of a frame are not those of the mask");
                    format!("off={off} {accuracy}")
                }
                // Where `f32` cannot decide a side, the adapter may choose either: the difference is
                // reported, not asserted.
                Kind::Gpu => format!("off={off} {accuracy}"),
            };
            let (lights, mut turn) = (&lights, (0..lights.len()).cycle());
            Contender::new(name, move || {
                let place = turn.next().expect("it never ends");
                let check = |(): &()| {
                    assert!(self.canvas.stencil() == pictures[place], "{name}: another picture");
                    answer.clone()
                };
                timed(|| self.frame(kind, &lights[place]), check)
            })
        });
        let (mesh, contenders) = (named(self.caster.mesh(), gpu), contenders.into());
        bench.run(Group { stage: "frames", mesh, units: 1, unit: "frame", contenders });
    }

    /// Renders one frame: submits it and waits for it.
    fn frame(&self, kind: Kind, light: &Light) {
        submit(self.pass.gpu(), |encoder| {
            let volume = match kind {
                Kind::NoShadows => None,
                Kind::Cpu => {
                    let mut facing = self.facing.borrow_mut();
                    self.caster.planes().classify_into(self.caster.mesh(), light, &mut facing);
                    Some(upload(self.pass.gpu(), &self.extrude(light, &CasterFaces::All.signs(&facing))))
                }
                Kind::Gpu => Some(self.extrusion.record(encoder, light).expect("it fits")),
            };
            draw(self.pass, encoder, &self.canvas, &self.view, &self.receivers, volume.as_ref());
        });
    }

    fn picture(&self, kind: Kind, light: &Light) -> Vec<u8> {
        self.frame(kind, light);
        if kind == Kind::Gpu {
            let demand = self.extrusion.download_demand().expect("it is there");
            assert_eq!(demand.exceeded, 0, "a volume does not fit");
        }
        self.canvas.stencil()
    }

    fn extrude(&self, light: &Light, signs: &[i8]) -> ShadowVolume {
        let silhouette = Silhouette::extract(self.caster.topology(), signs);
        ShadowVolume::extrude(
            self.caster.mesh(),
            self.caster.topology(),
            light,
            signs,
            &silhouette,
            Caps::Both,
        )
    }

    /// The volume of exact sides on the device, and the mask that the stencil pass draws from this volume.
    fn exact(&self, light: &Light) -> (GpuVolume, ShadowMask) {
        let signs = CasterFaces::All.signs(&self.caster.facing(light));
        let volume = upload(self.pass.gpu(), &self.extrude(light, &signs));
        let draws = [Draw { volume: &volume, method: StencilMethod::ZFail }];
        let View { projection, size, .. } = &self.view;
        let mask = self.pass.mask(projection, *size, &self.receivers, &draws, Counting::Stencil);
        (volume, mask.expect("it fits"))
    }

    /// Number of pixels that differ from the exact oracle: those explained by their footprint, and those
    /// unexplained.
    fn accuracy(&self, light: &Light, mask: &ShadowMask) -> String {
        let signs = CasterFaces::All.signs(&self.caster.facing(light));
        let (caster, projection) = (&self.caster, &self.view.projection);
        let rendered = Rendered {
            caster,
            seen: None,
            signs: &signs,
            light,
            projection,
            seen_from: 0.0,
            mask,
            unsure: &[],
        };
        let found = compare(&rendered, 0, &|_| {});
        let [shadowed, grazing, overflow, real] =
            [PixelVerdict::Shadowed, PixelVerdict::Grazing, PixelVerdict::Overflow, PixelVerdict::Real]
                .map(|verdict| found.count(verdict));
        assert_eq!(overflow, 0, "the stencil has wrapped");
        if self.pass.depth() == Depth::Plane {
            assert_eq!(real, 0, "pixels that nothing explains");
        }
        format!("shadowed={shadowed} grazing={grazing} real={real}")
    }
}

/// A camera and lights fitted to a mesh.
struct View {
    bounds: Aabb,
    size: Size,
    projection: Projection,
}

impl View {
    fn of(mesh: &Mesh) -> Self {
        let bounds = Aabb::around(mesh.positions().iter().copied());
        let size = Size::new(SIDE, SIDE).expect("a picture");
        let camera = Camera::fit(&bounds, Up::Y, 1.0);
        let distance = (camera.eye - Vec3::from(bounds.center())).length();
        Self { bounds, size, projection: camera.projection(size, 0.1 * distance) }
    }

    /// A point light above and outside the mesh, turned by an angle in radians.
    fn light(&self, turned: f32) -> Light {
        let (center, reach) = (self.bounds.center(), self.bounds.diagonal() as f32);
        let (sin, cos) = (0.5 + turned).sin_cos();
        Light::point([center[0] + 0.8 * reach * cos, center[1] + 1.1 * reach, center[2] + 0.8 * reach * sin])
            .expect("finite")
    }
}

/// Frames with a volume built in advance, and the number of pixels that the cheaper depth gets wrong.
fn one_volume(bench: &mut Bench<'_>, gpu: &Gpu) {
    let mesh = head(bench.quick);
    let passes =
        [Depth::Plane, Depth::Interpolated].map(|depth| StencilPass::new(gpu, depth).expect("it compiles"));
    let stages = passes.each_ref().map(|pass| Stage::new(pass, &mesh));
    let light = stages[0].view.light(0.0);
    let names = [
        ("Depth::Plane", "Depth::Plane · no shadows"),
        ("Depth::Interpolated", "Depth::Interpolated · no shadows"),
    ];
    let target = if gpu.is_software() { Target::Time(120e6) } else { Target::None };
    let mut contenders = Vec::new();
    for (stage, (name, plain)) in stages.iter().zip(names) {
        let (volume, mask) = stage.exact(&light);
        let accuracy = stage.accuracy(&light, &mask);
        let frame = move |volume: Option<&GpuVolume>| {
            submit(gpu, |encoder| {
                draw(stage.pass, encoder, &stage.canvas, &stage.view, &stage.receivers, volume);
            });
        };
        let shadowed = move || {
            let check = |(): &()| {
                let picture = stage.canvas.stencil();
                assert!(picture.iter().map(|&count| i32::from(count)).eq(mask.raw().iter().copied()));
                accuracy.clone()
            };
            timed(|| frame(Some(&volume)), check)
        };
        contenders.push(Contender::new(name, shadowed).aims_at(target));
        contenders.push(Contender::new(plain, move || {
            timed(|| frame(None), |()| format!("sky={}", stage.canvas.sky()))
        }));
    }
    let mesh = named(&mesh, gpu);
    bench.run(Group { stage: "frames of one volume", mesh, units: 1, unit: "frame", contenders });
}

/// Preparation of a mesh, done once.
fn preparation(bench: &mut Bench<'_>, gpu: &Gpu, mesh: &Mesh) {
    let caster = Caster::new(mesh.clone());
    let topology = caster.topology();
    let _ = caster.planes(); // measured by another stage
    let uploaded = GpuTopology::upload(gpu, topology).expect("it fits");
    let words = uploaded.download(gpu).expect("it is there");
    let volumes = VolumeShaders::new(gpu).expect("they compile");
    let builder = GpuTopologyBuilder::new(gpu).expect("it compiles");
    let edges = |count| format!("edges={count}");
    let contenders = vec![
        Contender::new("Topology::build", || {
            let build = || Topology::of(mesh);
            timed(build, |topology| edges(topology.edge_count()))
        })
        .expects(edges(topology.edge_count())),
        Contender::new("GpuTopologyBuilder::build", || {
            let build = || {
                let (vertices, faces) = (uploaded.vertex_count(), uploaded.face_count());
                let topology = builder.build(gpu, vertices, uploaded.triangles(), faces).expect("it fits");
                wait(gpu);
                topology
            };
            timed(build, |topology| {
                assert!(topology.download(gpu).expect("it is there") == words, "another edge table");
                edges(topology.edge_count() as usize)
            })
        })
        .expects(edges(topology.edge_count())),
        Contender::new("upload and room for a light", || {
            let build = || {
                let uploaded = GpuCaster::upload(gpu, &caster).expect("it fits");
                let room = GpuExtrusion::new(&volumes, &uploaded, Caps::Both, None).expect("it fits");
                wait(gpu);
                room
            };
            timed(build, |_| "made".to_owned())
        }),
    ];
    let (units, mesh) = (mesh.face_count(), named(mesh, gpu));
    bench.run(Group { stage: "frames prepared", mesh, units, unit: "triangle", contenders });
}

fn upload(gpu: &Gpu, volume: &ShadowVolume) -> GpuVolume {
    GpuVolume::upload(gpu, volume).expect("it fits")
}

/// Records the receivers, and a volume counted by z-fail.
fn draw(
    pass: &StencilPass,
    encoder: &mut wgpu::CommandEncoder,
    canvas: &Canvas<'_>,
    view: &View,
    receivers: &GpuCaster,
    volume: Option<&GpuVolume>,
) {
    let draws = volume.map(|volume| Draw { volume, method: StencilMethod::ZFail });
    let frame = pass.prepare(&view.projection, view.size, receivers, draws.as_slice()).expect("it fits");
    let mut drawing = canvas.begin(encoder);
    frame.draw_receivers(&mut drawing);
    frame.draw_volumes(&mut drawing);
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)))
}

/// The table cell that names a mesh and an adapter.
fn named(mesh: &Mesh, gpu: &Gpu) -> String {
    format!("{} of {} triangles · {}", mesh.name, mesh.face_count(), gpu.name()).replace(',', " ·")
}
