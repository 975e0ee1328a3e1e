//! Openness by the method that was asked for.

use umbrage::ambient::disks::{Disks, Emitters, Passes};
use umbrage::ambient::{
    Ambient, Ask, Effort, RayOptions, Reach, Receivers, Ring, exact_bent_part, exact_part,
};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::oracle::area::SoftOracle;

use super::input::Input;
use super::inside::Worst;
use super::{Args, FalloffArg, Found, Method, PerArg, note};
use crate::cli::progress::Progress;
use crate::cli::{Failure, output};

/// The values, and the one of each corner of each face, in the order of the file.
pub(super) struct Values {
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) ambient: Ambient,
    rays: Option<u32>,
    ring: bool,
    asks_inside: bool,
    pub(super) worst: Option<Worst>,
}

/// The openness of points.
type Openness = Box<dyn FnMut(&Receivers) -> Vec<f32>>;

pub(super) fn values(args: &Args, input: &Input) -> Result<Values, Failure> {
    let receivers = receivers(args, input);
    let list = receivers.list();
    let progress = Progress::bar("ambient occlusion", list.len() as u64);
    let casting: Vec<&Mesh> = input.casting.iter().collect();
    let (mut rays, mut ring) = (None, false);
    let mut ambient;
    // The openness of further points, by the same method.
    let mut inside: Openness;
    match args.method {
        Method::Rays => {
            let (oracle, options) = (Oracle::over(&casting), options(args));
            let cast;
            (ambient, cast) = Ambient::by_rays(&oracle, &receivers, &options, &|count| progress.done(count));
            (rays, ring) = (Some(cast.rays), cast.ring && !args.fit);
            let options =
                RayOptions { effort: Effort::Rays(cast.rays), ring: Ring::Off, bent: false, ..options };
            inside = Box::new(move |points| Ambient::by_rays(&oracle, points, &options, &|_| {}).0.openness);
        }
        Method::Exact => {
            let soft = SoftOracle::over(&casting);
            let (mut openness, mut bent) = (Vec::with_capacity(list.len()), args.bent.then(Vec::new));
            for start in (0..list.len()).step_by(RUN) {
                let part = start..list.len().min(start + RUN);
                progress.done(part.len() as u64);
                let found = if args.bent {
                    exact_bent_part(&soft, &receivers, part)
                } else {
                    exact_part(&soft, &receivers, part)
                };
                openness.extend(found.openness.into_iter().map(|open| open as f32));
                if let Some(bent) = &mut bent {
                    bent.extend(found.bent.unwrap_or_default());
                }
            }
            ambient = Ambient { openness, bent, ..Ambient::default() };
            inside = Box::new(move |points| {
                Ambient::from(exact_part(&soft, points, 0..points.list().len())).openness
            });
        }
        Method::Disks => {
            let mut disks = Disks::of(&casting, Emitters::Vertices);
            disks.run(&Passes::default());
            ambient = disks.openness(list);
            inside = Box::new(move |points| disks.openness(points.list()).openness);
        }
    }
    drop(progress);
    let worst = look_inside(args, input, &receivers, &mut ambient, &mut *inside);
    drop(inside);
    let mut corners = vec![[0; 3]; input.order.len()];
    for (&face, own) in input.order.iter().zip(receivers.corners()) {
        corners[face as usize] = *own;
    }
    let asks_inside = args.method == Method::Rays;
    if !ambient.inside.is_empty() && !args.fit {
        let inside = output::counted(ambient.inside.len(), "point is", "points are");
        note(args, format_args!("{inside} inside another solid, and dark"));
    }
    Ok(Values { corners, ambient, rays, ring, asks_inside, worst })
}

/// Fits the values to what is inside faces, and finds the worst error there, where this is asked for.
fn look_inside(
    args: &Args,
    input: &Input,
    receivers: &Receivers,
    ambient: &mut Ambient,
    ask: Ask<'_>,
) -> Option<Worst> {
    let pieces = args.inside()?;
    if args.fit {
        ambient.openness = receivers.fit(&ambient.openness, pieces, &mut *ask);
    }
    let error = receivers.inside_error(&ambient.openness, pieces, ask)?;
    Worst::of(input, error)
}

/// Receivers between two steps of progress.
const RUN: usize = 1024;

fn receivers(args: &Args, input: &Input) -> Receivers {
    let all = input.all();
    if args.per != PerArg::Corner || input.normals.iter().all(Option::is_none) {
        return Receivers::of(&all, args.per.into());
    }
    let mut first = vec![0];
    for mesh in &all {
        first.push(first[first.len() - 1] + mesh.face_count());
    }
    let given = |mesh: usize, face: FaceId| input.normals[input.order[first[mesh] + face.index()] as usize];
    let (receivers, bad) = Receivers::with_normals(&all, given);
    if bad > 0 {
        let bad = output::counted(bad, "normal is", "normals are");
        note(args, format_args!("{bad} no direction (zero, or not finite) and worked out anew"));
    }
    receivers
}

fn options(args: &Args) -> RayOptions {
    let effort = match (args.error, args.rays) {
        (Some(error), _) => Effort::Error(error),
        (None, Some(rays)) => Effort::Rays(rays),
        (None, None) => RayOptions::default().effort,
    };
    let reach = match (args.distance, args.ambient_falloff) {
        (None, _) => Reach::Unlimited,
        (Some(distance), FalloffArg::None) => Reach::Within(distance),
        (Some(distance), FalloffArg::Linear) => Reach::Fading(distance),
    };
    RayOptions { effort, reach, bent: args.bent, ..RayOptions::default() }
}

impl Values {
    pub(super) fn found(&self, seconds: f64) -> Found {
        let openness = &self.ambient.openness;
        let sum: f64 = openness.iter().map(|&open| f64::from(open)).sum();
        Found {
            receivers: openness.len(),
            rays: self.rays,
            ring: self.ring,
            mean_openness: sum / openness.len() as f64,
            standard_error: self.ambient.standard_error,
            inside: self.asks_inside.then_some(self.ambient.inside.len()),
            seconds,
        }
    }
}
