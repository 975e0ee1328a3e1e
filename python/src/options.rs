//! Options and lights.

use std::ops::RangeInclusive;

use pyo3::prelude::*;
use pyo3::types::PyString;
use umbrage::check::Requirement;
use umbrage::geom::Light;
use umbrage::mesh::Weld;
use umbrage::oracle::area::AreaLight;
use umbrage::scene::{Lamp, Scope};

use crate::error::Problem;

/// One of several names.
pub(crate) fn one_of<T: Copy>(
    py: Python<'_>,
    argument: &'static str,
    name: &str,
    all: &[(&str, T)],
) -> PyResult<T> {
    match all.iter().find(|(known, _)| *known == name) {
        Some((_, value)) => Ok(*value),
        None => {
            let names: Vec<String> = all.iter().map(|(known, _)| format!("{known:?}")).collect();
            let remedy = format!("write {}", names.join(", "));
            Err(Problem::new(argument, format!("{name:?} is unknown"), remedy).raise(py))
        }
    }
}

/// Which vertices are the same: "exact", "none", or a distance. Without any: exact.
pub(crate) fn weld(value: Option<&Bound<'_, PyAny>>) -> PyResult<Weld> {
    let Some(value) = value else { return Ok(Weld::Exact) };
    if let Ok(name) = value.cast::<PyString>() {
        return match name.to_cow()?.as_ref() {
            "exact" => Ok(Weld::Exact),
            "none" => Ok(Weld::None),
            name => Err(not_a_weld(value.py(), &format!("{name:?}"))),
        };
    }
    match value.extract::<f64>() {
        Ok(distance) => distance_of(value.py(), "weld", distance).map(Weld::Within),
        Err(_) => Err(not_a_weld(value.py(), &value.repr()?.to_cow()?)),
    }
}

fn not_a_weld(py: Python<'_>, what: &str) -> PyErr {
    let remedy = "write \"exact\", \"none\", or a distance above 0 in mesh units";
    Problem::new("weld", format!("{what} is no weld"), remedy).raise(py)
}

/// A distance above 0, as `f32`.
pub(crate) fn distance_of(py: Python<'_>, argument: &'static str, distance: f64) -> PyResult<f32> {
    let rounded = distance as f32;
    if rounded > 0.0 && rounded.is_finite() {
        return Ok(rounded);
    }
    let remedy = "pass a distance above 0 in mesh units, within the range of float32";
    Err(Problem::new(argument, format!("{distance} is no distance"), remedy).raise(py))
}

/// An integer in a range; `otherwise` where none is given.
pub(crate) fn integer(
    argument: &'static str,
    value: Option<&Bound<'_, PyAny>>,
    range: RangeInclusive<u64>,
    otherwise: u64,
) -> PyResult<u64> {
    let Some(value) = value else { return Ok(otherwise) };
    match value.extract::<u64>() {
        Ok(number) if range.contains(&number) => Ok(number),
        _ => {
            let problem = format!("{} is out of range", value.repr()?);
            let remedy = format!("pass an integer from {} to {}", range.start(), range.end());
            Err(Problem::new(argument, problem, remedy).raise(value.py()))
        }
    }
}

/// How many defects are listed.
pub(crate) fn limit(value: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
    Ok(integer("limit", value, 0..=u64::from(u32::MAX), 5)? as usize)
}

/// What counts as one mesh.
pub(crate) fn scope(py: Python<'_>, name: &str) -> PyResult<Scope> {
    let all = [("mesh", Scope::Mesh), ("primitive", Scope::Primitive), ("scene", Scope::Scene)];
    one_of(py, "scope", name, &all)
}

/// What is required of every mesh, in the order of a report: as the command does it.
pub(crate) fn requirements(
    py: Python<'_>,
    names: Option<Vec<String>>,
    self_intersections: bool,
) -> PyResult<Vec<Requirement>> {
    let names = names.unwrap_or_else(|| vec![Requirement::Sound.name().to_owned()]);
    let known = Requirement::ALL.map(|requirement| (requirement.name(), requirement));
    let mut all: Vec<Requirement> =
        names.iter().map(|name| one_of(py, "require", name, &known)).collect::<PyResult<_>>()?;
    all.push(Requirement::NotEmpty);
    all.extend(self_intersections.then_some(Requirement::NoSelfIntersections));
    all.sort_unstable();
    all.dedup();
    Ok(all)
}

/// A light without an extent, for hard shadows.
pub(crate) fn hard_light(value: &Bound<'_, PyAny>) -> PyResult<Light> {
    let lamp = lamp(value)?;
    if lamp.has_extent() {
        let problem = format!("{lamp} has an extent, so that a point may see a part of it");
        let remedy = "ask for visible_fraction, or leave the extent out";
        return Err(Problem::new("light", problem, remedy).raise(value.py()));
    }
    Ok(*lamp.light())
}

/// A light with an extent.
pub(crate) fn area_light(value: &Bound<'_, PyAny>) -> PyResult<AreaLight> {
    let py = value.py();
    let lamp = lamp(value)?;
    match AreaLight::of_lamp(&lamp) {
        Ok(Some(light)) => Ok(light),
        Ok(None) => {
            let problem = format!("{lamp} has no extent: a point sees all of it, or nothing");
            let remedy = "add ,radius=R or ,angle=DEGREES, or ask for verdicts";
            Err(Problem::new("light", problem, remedy).raise(py))
        }
        Err(error) => Err(Problem::new("light", error.to_string(), "give it another extent").raise(py)),
    }
}

/// A light as the command line writes it, or as four homogeneous coordinates.
fn lamp(value: &Bound<'_, PyAny>) -> PyResult<Lamp> {
    let py = value.py();
    let wrong = |problem: String| Problem::new("light", problem, SYNTAX).raise(py);
    if let Ok(text) = value.cast::<PyString>() {
        let lamp: Lamp = text.to_cow()?.parse().map_err(|error| wrong(format!("{error}")))?;
        if lamp.cone.is_some() || lamp.range.is_some() {
            let problem = format!("{lamp} has a cone or a range, which change no shadow");
            return Err(Problem::new("light", problem, "leave them out: point:X,Y,Z").raise(py));
        }
        return Ok(lamp);
    }
    let Ok(numbers) = value.extract::<Vec<f64>>() else {
        return Err(wrong(format!("{} is no light", value.repr()?)));
    };
    let [x, y, z, w] = numbers[..] else {
        return Err(wrong(format!("{} numbers are no light", numbers.len())));
    };
    let xyz = [x, y, z].map(|x| x as f32);
    let light = match w {
        1.0 => Light::point(xyz),
        // Towards the light; it travels the other way.
        0.0 => Light::directional(xyz.map(|x| -x)),
        _ => return Err(wrong(format!("w is {w}, not 1 (a point) or 0 (a direction)"))),
    };
    light.map(Lamp::from).map_err(|error| wrong(error.to_string()))
}

const SYNTAX: &str = "write \"point:X,Y,Z\", \"directional:X,Y,Z\" (the direction in which it travels), or four \
                      numbers: x, y, z, 1 for a point, or x, y, z, 0 for the direction towards the light";
