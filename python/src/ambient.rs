//! Ambient occlusion.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use umbrage::ambient::{Ambient, Effort, MOST_RAYS, Per, RayOptions, Reach, Receivers, Ring, exact_part};
use umbrage::mesh::Mesh;
use umbrage::oracle::Oracle;
use umbrage::oracle::area::SoftOracle;

use crate::error::Problem;
use crate::{arrays, options, results};

/// How openness is worked out.
#[derive(Clone, Copy)]
enum Method {
    Rays,
    Exact,
}

/// What was found, and the bound of the error where there is one.
struct Found {
    receivers: Receivers,
    openness: Openness,
    bent: Option<Vec<[f32; 3]>>,
    inside: Vec<u32>,
    standard_error: Option<f64>,
    bound: Option<f64>,
}

enum Openness {
    Rays(Vec<f32>),
    Exact(Vec<f64>),
}

/// Ambient occlusion: how much of the sky above a surface no face hides, weighted by the cosine.
///
/// Openness is 1 with nothing in the way and 0 inside a closed shell; occlusion is 1 less openness.
///
/// Parameters
/// ----------
/// vertices : array_like, shape (n, 3)
/// faces : array_like of integers, shape (m, 3)
///     As for `check_arrays`.
/// method : "rays" (default) or "exact"
///     Exact rays, about 0.5 µs each; or the analytic form, about 0.1 µs a point and face.
/// rays : int
///     Rays from each point, 1 to 2**20.
/// error : float, optional
///     Instead: as many rays as keep the standard error of a value at this size.
/// seed : int
///     Another one draws other directions.
/// distance : float, optional
///     How far a face may be to hide, in mesh units.
/// falloff : "none" (default) or "linear"
///     Whether a face hides less towards that distance.
/// per : "corner" (default), "vertex" or "face"
///     What gets a value: each position and normal, each position, each face at its middle.
/// bent : bool
///     Also the mean open direction.
///
/// Returns
/// -------
/// Ambient
///     ``openness`` (k,), float32 by rays, float64 exact; ``points`` (k, 3) float32; ``normals`` (k, 3)
///     float32, NaN where two sides of a sheet meet; ``corners`` (m, 3) uint32, for each corner of a face the
///     index of its value; ``bent`` (k, 3) float32 or None; ``inside`` (j,) uint32, values inside the solid
///     of another shell; ``standard_error`` of one value, by rays; ``bound``, the most that an exact value
///     differs from the truth; ``rounding`` as in `check_arrays`.
///
/// Examples
/// --------
/// >>> ambient = umbrage.ambient(*umbrage.shapes.cube(), rays=16)
/// >>> len(ambient.openness), float(ambient.openness.min())  # three normals at each vertex, all open
/// (24, 1.0)
#[pyfunction]
#[pyo3(
    signature = (vertices, faces, *, method="rays", rays=None, error=None, seed=None, distance=None,
        falloff="none", per="corner", bent=false),
    text_signature = "(vertices, faces, *, method='rays', rays=64, error=None, seed=1, distance=None, \
        falloff='none', per='corner', bent=False)"
)]
#[expect(clippy::too_many_arguments, reason = "they are options with names")]
pub(crate) fn ambient<'py>(
    py: Python<'py>,
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    method: &str,
    rays: Option<&Bound<'_, PyAny>>,
    error: Option<f64>,
    seed: Option<&Bound<'_, PyAny>>,
    distance: Option<f64>,
    falloff: &str,
    per: &str,
    bent: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let method = options::one_of(py, "method", method, &[("rays", Method::Rays), ("exact", Method::Exact)])?;
    let kinds = [("corner", Per::Corner), ("vertex", Per::Vertex), ("face", Per::Face)];
    let per = options::one_of(py, "per", per, &kinds)?;
    let is_linear = options::one_of(py, "falloff", falloff, &[("none", false), ("linear", true)])?;
    let distance = distance.map(|distance| options::distance_of(py, "distance", distance)).transpose()?;
    let options = RayOptions {
        effort: effort(py, rays, error)?,
        seed: options::integer("seed", seed, 0..=u64::MAX, 1)?,
        reach: match distance {
            None if is_linear => {
                let problem = "needs a distance at which faces hide nothing any more";
                return Err(Problem::new("falloff", problem, "pass distance=D").raise(py));
            }
            None => Reach::Unlimited,
            Some(distance) if is_linear => Reach::Fading(distance),
            Some(distance) => Reach::Within(distance),
        },
        ring: Ring::Auto,
        bent,
    };
    if matches!(method, Method::Exact) && (bent || distance.is_some()) {
        let argument = if bent { "bent" } else { "distance" };
        let problem = "is only known by rays";
        return Err(Problem::new(argument, problem, "leave it out, or pass method=\"rays\"").raise(py));
    }
    let (mesh, rounding) = arrays::mesh(vertices, faces)?;
    let found = py.detach(|| find(&mesh, method, per, &options));
    let list = found.receivers.list();
    let openness = match found.openness {
        Openness::Rays(openness) => PyArray1::from_vec(py, openness).into_any(),
        Openness::Exact(openness) => PyArray1::from_vec(py, openness).into_any(),
    };
    let normal = |normal: Option<[f32; 3]>| normal.unwrap_or([f32::NAN; 3]);
    let fields = (
        openness,
        results::table(py, list.iter().map(|receiver| receiver.point).collect()),
        results::table(py, list.iter().map(|receiver| normal(receiver.normal)).collect()),
        results::table(py, found.receivers.corners().to_vec()),
        found.bent.map(|bent| -> Bound<'py, PyArray2<f32>> { results::table(py, bent) }),
        PyArray1::from_vec(py, found.inside),
        found.standard_error,
        found.bound,
        rounding,
    );
    results::named(py, "Ambient", fields)
}

fn effort(py: Python<'_>, rays: Option<&Bound<'_, PyAny>>, error: Option<f64>) -> PyResult<Effort> {
    match error {
        None => Ok(Effort::Rays(options::integer("rays", rays, 1..=u64::from(MOST_RAYS), 64)? as u32)),
        Some(error) if error > 0.0 && error.is_finite() => Ok(Effort::Error(error)),
        Some(error) => {
            let remedy = "pass a number above 0, such as 0.01";
            Err(Problem::new("error", format!("{error} is no error"), remedy).raise(py))
        }
    }
}

fn find(mesh: &Mesh, method: Method, per: Per, options: &RayOptions) -> Found {
    let receivers = Receivers::of(&[mesh], per);
    match method {
        Method::Rays => {
            let (ambient, _) = Ambient::by_rays(&Oracle::build(mesh), &receivers, options, &|_| {});
            let Ambient { openness, bent, inside, standard_error } = ambient;
            Found { receivers, openness: Openness::Rays(openness), bent, inside, standard_error, bound: None }
        }
        Method::Exact => {
            let count = receivers.list().len();
            let found = exact_part(&SoftOracle::build(mesh), &receivers, 0..count);
            Found {
                receivers,
                openness: Openness::Exact(found.openness),
                bent: None,
                inside: Vec::new(),
                standard_error: None,
                bound: Some(found.bound),
            }
        }
    }
}
