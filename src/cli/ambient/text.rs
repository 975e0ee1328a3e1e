//! What `umbrage ambient` prints for people.

use super::inside::Worst;
use super::{Args, Found};
use crate::cli::output::{plain, significant};

/// Three digits are more than the error leaves.
fn short(value: f64) -> String {
    significant((value * 1e3).round() / 1e3)
}

pub(super) fn report(args: &Args, found: &Found, worst: Option<&Worst>) -> String {
    let mut method = args.method.name().to_owned();
    if let Some(rays) = found.rays {
        method += &format!(", {rays} a point");
    }
    if found.ring {
        method += ", mean with neighbors";
    }
    if args.fit {
        method += ", fitted inside faces";
    }
    let mut lines = vec![
        ("points", found.receivers.to_string()),
        ("method", method),
        ("mean openness", short(found.mean_openness)),
    ];
    if let Some(error) = found.standard_error {
        let which = match found {
            _ if args.fit => " of one value, before the fit",
            Found { ring: true, .. } => " of one value, before the mean",
            _ => " of one value",
        };
        lines.push(("standard error", format!("{}{which}", significant((error * 1e5).round() / 1e5))));
    }
    if let Some(inside) = found.inside {
        lines.push(("inside a solid", inside.to_string()));
    }
    if let Some(worst) = worst {
        lines.push(("error in faces", worst.text()));
    }
    lines.push(("seconds", short(found.seconds)));
    let mut text = format!("{}\n", plain(&args.file.to_string_lossy()));
    for (name, value) in lines {
        text += &format!("  {name:<15} {value}\n");
    }
    text
}
