//! Openness by the method that was asked for.

use umbrage::ambient::disks::{Disks, Emitters, Passes};
use umbrage::ambient::{Ambient, Effort, RayOptions, Reach, Receivers, exact};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::oracle::area::SoftOracle;

use super::input::Input;
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
}

pub(super) fn values(args: &Args, input: &Input) -> Result<Values, Failure> {
    let receivers = receivers(args, input);
    let list = receivers.list();
    let progress = Progress::bar("ambient occlusion", list.len() as u64);
    let casting: Vec<&Mesh> = input.casting.iter().collect();
    let (mut rays, mut ring) = (None, false);
    let ambient = match args.method {
        Method::Rays => {
            let (ambient, cast) =
                Ambient::by_rays(&Oracle::over(&casting), &receivers, &options(args), &|count| {
                    progress.done(count)
                });
            (rays, ring) = (Some(cast.rays), cast.ring);
            ambient
        }
        Method::Exact => exact(&SoftOracle::over(&casting), &receivers, &|count| progress.done(count)).into(),
        Method::Disks => {
            let mut disks = Disks::of(&casting, Emitters::Vertices);
            disks.run(&Passes::default());
            disks.openness(list)
        }
    };
    drop(progress);
    let mut corners = vec![[0; 3]; input.order.len()];
    for (&face, own) in input.order.iter().zip(receivers.corners()) {
        corners[face as usize] = *own;
    }
    let asks_inside = args.method == Method::Rays;
    if !ambient.inside.is_empty() {
        let inside = output::counted(ambient.inside.len(), "point is", "points are");
        note(args, format_args!("{inside} inside another solid, and dark"));
    }
    Ok(Values { corners, ambient, rays, ring, asks_inside })
}

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
