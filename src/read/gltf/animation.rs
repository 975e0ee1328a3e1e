//! Animations as clips.

use std::collections::HashMap;
use std::sync::Arc;

use super::accessor;
use super::asset::Asset;
use super::document::Kind;
use super::object::Object;
use crate::animate::{Channel, Clip, Interpolation, Node, Property, Track};
use crate::read::ReadError;

/// The clips of the document, in its order. One that is wrong has a problem. A node that a clip moves is in
/// parts afterwards.
pub(super) fn read(
    asset: &Asset,
    of_document: &[Option<usize>],
    nodes: &mut [Node],
    targets: &[usize],
) -> Vec<Clip> {
    let document = asset.document.object();
    let list = match document.list("animations") {
        Ok(list) => list,
        Err(error) => {
            let clip = Clip { problem: Some(problem(&error)), ..Clip::default() };
            return vec![clip];
        }
    };
    let mut clips = Vec::with_capacity(list.len());
    for (index, value) in list.iter().enumerate() {
        let place = format!("animation {index}");
        let clip = Object::new(place.clone(), value).and_then(|object| {
            let channels = channels(asset, &object, of_document, targets)?;
            Ok(Clip { name: object.name(), channels, problem: None })
        });
        let clip = clip.unwrap_or_else(|error| {
            let name = value.get("name").and_then(|name| name.as_str()).unwrap_or(&place).to_owned();
            Clip { name, channels: Vec::new(), problem: Some(problem(&error)) }
        });
        for channel in clip.channels.iter().filter(|channel| channel.property != Property::Weights) {
            let node = &mut nodes[channel.node];
            if node.local.is_matrix() {
                asset.notes.add("matrix of a node that a clip moves taken apart", &node.place);
                node.local = node.local.in_parts();
            }
        }
        clips.push(clip);
    }
    clips
}

/// The text of an error without its file: place, problem, remedy.
pub(super) fn problem(error: &ReadError) -> String {
    error.to_string().trim_start_matches([',', ' ']).to_owned()
}

/// What a channel makes of a sampler: its accessors, and what it moves.
type Sampled = (usize, Property, usize);

fn channels(
    asset: &Asset,
    animation: &Object,
    of_document: &[Option<usize>],
    targets: &[usize],
) -> Result<Vec<Channel>, ReadError> {
    let (document, notes) = (asset.document, asset.notes);
    let samplers = animation.list("samplers")?.len();
    let mut tracks: HashMap<Sampled, Arc<Track>> = HashMap::new();
    let mut channels: Vec<Channel> = Vec::new();
    let mut taken: HashMap<(usize, &str), ()> = HashMap::new();
    for channel in animation.objects("channels", "channel")? {
        let channel = channel?;
        let target = channel.required("target", channel.object("target")?)?;
        let path = target.required("path", target.text("path")?)?;
        let property = match path {
            "translation" => Property::Translation,
            "rotation" => Property::Rotation,
            "scale" => Property::Scale,
            "weights" => Property::Weights,
            "pointer" => {
                notes.add("channel of KHR_animation_pointer left out", &channel.place);
                continue;
            }
            _ => {
                notes.add("channel of a path that glTF does not know left out", &channel.place);
                continue;
            }
        };
        let Some(node) = target.whole("node")? else {
            notes.add("channel without a node left out", &channel.place);
            continue;
        };
        if node >= document.list(Kind::Node).len() {
            let why = || format!("there is no node {node}");
            notes.because("channel of a node that does not exist left out", &channel.place, why);
            continue;
        }
        let Some(at) = of_document[node] else {
            notes.add("channel of a node outside of the scene left out", &channel.place);
            continue;
        };
        if property == Property::Weights && targets[at] == 0 {
            notes.add("channel of morph weights without a target left out", &channel.place);
            continue;
        }
        if taken.insert((node, path), ()).is_some() {
            notes.add("second channel of a node and path left out", &channel.place);
            continue;
        }
        let sampler = channel.required("sampler", channel.whole("sampler")?)?;
        if sampler >= samplers {
            return Err(channel.error(format!("names sampler {sampler}, but there are {samplers}")));
        }
        let width = match property {
            Property::Rotation => 4,
            Property::Weights => targets[at],
            _ => 3,
        };
        let key = (sampler, property, width);
        let track = match tracks.get(&key) {
            Some(track) => Arc::clone(track),
            None => {
                let list = animation.list("samplers")?;
                let place = format!("{}, sampler {sampler}", animation.place);
                let track = track(asset, &Object::new(place, &list[sampler])?, property, width)?;
                Arc::clone(tracks.entry(key).or_insert(Arc::new(track)))
            }
        };
        channels.push(Channel { node: at, property, track });
    }
    Ok(channels)
}

fn track(asset: &Asset, sampler: &Object, property: Property, width: usize) -> Result<Track, ReadError> {
    let document = asset.document;
    let link = |key| sampler.required(key, sampler.link(key, document, Kind::Accessor)?);
    let (input, output) = (link("input")?, link("output")?);
    let stated = match sampler.text("interpolation")? {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::CubicSpline,
        Some(other) => {
            let problem = format!("its interpolation is {}", crate::read::text::quote(other.as_bytes()));
            return Err(sampler.error(problem).remedy("use LINEAR, STEP or CUBICSPLINE"));
        }
    };
    let times: Vec<f32> = accessor::scalars(asset, input, "a time")?;
    let Some(last) = times.len().checked_sub(1) else {
        return Err(sampler.error("has no keys, but must have one at least"));
    };
    if let Some(key) = (1..=last).find(|&key| times[key] < times[key - 1]) {
        let (time, before) = (times[key], times[key - 1]);
        let problem =
            format!("its time {key} is {time}, which is before the time {before} of the key before");
        return Err(sampler.error(problem).remedy("sort the keys by time"));
    }
    if (1..=last).any(|key| times[key] == times[key - 1]) {
        asset.notes.add("keys of equal times taken for a jump", &sampler.place);
    }
    if times[0] < 0.0 {
        asset.notes.add("key before time 0 taken as it is", &sampler.place);
    }
    let interpolation = match stated {
        Interpolation::CubicSpline if last == 0 => {
            asset.notes.add("cubic spline of a single key held", &sampler.place);
            stated
        }
        _ => stated,
    };
    let values = match property {
        Property::Weights => accessor::scalars(asset, output, "a weight")?,
        Property::Rotation => accessor::vectors::<4>(asset, output, "a rotation")?.into_flattened(),
        _ => accessor::vectors::<3>(asset, output, "a translation or scale")?.into_flattened(),
    };
    let per_key = if interpolation == Interpolation::CubicSpline { 3 * width } else { width };
    let wanted = times.len().saturating_mul(per_key);
    if values.len() != wanted {
        let unit = if property == Property::Weights { 1 } else { width };
        let (values, wanted, keys) = (values.len() / unit, wanted / unit, times.len());
        let problem = format!("has {values} values for {keys} keys, but must have {wanted}");
        return Err(sampler.error(problem));
    }
    let track = Track { times, values, width, interpolation };
    if property == Property::Rotation
        && let Some(key) = (0..=last).find(|&key| track.is_zero(key))
    {
        return Err(sampler.error(format!("its key {key} is a rotation of length zero")));
    }
    Ok(track)
}
