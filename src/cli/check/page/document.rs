//! The HTML of the page: verdict and counts, the view, the list of defects, six pictures.

use maud::{Markup, html};
use umbrage::check::DefectKind;
use umbrage::mesh::{FaceId, Origin};
use umbrage::view::{Size, Up};

use super::geometry::{self, Shown};
use super::{OfKind, Page, ROWS, Row, severity};
use crate::cli::Failure;
use crate::cli::chart::number as grouped;
use crate::cli::check::drawn::color;
use crate::cli::check::report::{FileReport, MeshReport};
use crate::cli::check::text::{self, Faces, label, noun};
use crate::cli::color::Painter;
use crate::cli::output::{counted, plain, short, significant};
use crate::cli::page;

const STYLE: &str = include_str!("page.css");
/// The view, then the list that moves it.
const SCRIPT: &str = concat!(include_str!("view.js"), include_str!("list.js"));

/// Meshes that have a row.
const MESHES: usize = 100;
/// Faces that a row of the list names.
const FACES: usize = 3;

/// Size of each picture, in pixels.
const PICTURE: [u32; 2] = [320, 200];
/// Where the pictures look from: right, up, back.
const SIDES: [(&str, [f64; 3]); 6] = [
    ("front", [0.0, 0.0, 1.0]),
    ("right", [1.0, 0.0, 0.0]),
    ("back", [0.0, 0.0, -1.0]),
    ("left", [-1.0, 0.0, 0.0]),
    ("top", [0.0, 1.0, 0.0]),
    ("bottom", [0.0, -1.0, 0.0]),
];

pub(super) fn write(page: Page, report: &FileReport, up: Up) -> Result<String, Failure> {
    let (data, shown) = geometry::data(&page, report, up)?;
    let found = page.found();
    let file = plain(&report.file.file_name().unwrap_or(report.file.as_os_str()).to_string_lossy());
    let verdict = report.verdict().name();
    let list = html! {
        div.list tabindex="0" aria-label="defects" {
            @for (kind, of_kind) in &found { (kind_of_defect(*kind, of_kind, report)) }
        }
    };
    let head = html! {
        h1 { span class=(format!("verdict {}", verdict.replace(' ', "-"))) { (verdict) } " " (file) }
        @for line in (text::Report { report, limit: 5, painter: Painter::default() }).verdict_lines() { p { (plain(&line)) } }
        @if let Some((kind, _)) = found.first() { p { "Worst effect on the shadow: " (kind.effect()) "." } }
        (counts(report, &found))
        (meshes(report))
    };
    let limits = limits(&found, &shown);
    let has_defects = !found.is_empty();
    let [width, height] = PICTURE;
    let size = Size::new(width, height).expect("both are in range");
    let pictures = page.sketch.six_sides(up, size, SIDES.map(|(_, side)| side))?;
    let body = html! {
        (head)
        @if !has_defects { p { "No defects." } }
        div.stage {
            div.view hidden {
                canvas tabindex="0" aria-label="the mesh and its defects; drag to turn" {}
                p.buttons {
                    button type="button" id="reset" { "Reset view" }
                    @if has_defects {
                        button type="button" id="previous" { "Previous" }
                        button type="button" id="next" { "Next" }
                        button type="button" id="copy" { "Copy as JSON" }
                    }
                }
                p.selected aria-live="polite" {
                    @if has_defects {
                        "Arrow keys step through the defects, Enter flies to one again, Escape shows all. "
                    }
                    "Drag turns, with Shift it moves; the wheel zooms."
                }
            }
            @if has_defects { (list) }
        }
        @for line in &limits { p.faint { (line) } }
        p.missing hidden { "This browser has no WebGL 2, or it is switched off: the pictures below stand for the view." }
        details.sides open {
            summary { "From six sides" }
            div.pictures {
                @for ((name, _), picture) in SIDES.iter().zip(&pictures) {
                    figure {
                        img src=(page::picture_url(picture)) alt=(name) width=(width) height=(height);
                        figcaption { (name) }
                    }
                }
            }
        }
        p.faint { "Made by " code { "umbrage check --html" } " (umbrage " (env!("CARGO_PKG_VERSION")) ")." }
        (page::data("data", &data))
    };
    Ok(page::document(&format!("{file}: {verdict}"), STYLE, &body, SCRIPT))
}

/// How many defects of each kind there are, with the color of the kind and a switch for it.
fn counts(report: &FileReport, found: &[(DefectKind, &OfKind)]) -> Markup {
    let faces = report.sum(|mesh| mesh.counts.faces);
    html! {
        p.kinds {
            (grouped(faces as f64)) " faces in " (counted(report.meshes.len(), "mesh", "meshes"))
            @if !found.is_empty() { ":" }
            @for (kind, of_kind) in found {
                label { input type="checkbox" checked data-kind=(kind.name()) hidden;
                    (swatch(*kind)) (many(*kind, of_kind)) }
            }
        }
    }
}

fn swatch(kind: DefectKind) -> Markup {
    let [r, g, b] = color(kind).1;
    html! { span.key style=(format!("background:rgb({r},{g},{b})")) {} }
}

/// "at least 3 T-junctions".
fn many(kind: DefectKind, of_kind: &OfKind) -> String {
    let least = if of_kind.complete { "" } else { "at least " };
    format!("{least}{} {}", grouped(of_kind.count as f64), noun(kind, of_kind.count))
}

fn meshes(report: &FileReport) -> Markup {
    let number = |count: usize| html! { td { (grouped(count as f64)) } };
    let of_mesh = |index: usize, mesh: &MeshReport| {
        html! {
            tr {
                td { (label(index, mesh)) }
                (number(mesh.vertices)) (number(mesh.welded_vertices)) (number(mesh.counts.faces))
                (number(mesh.counts.edges)) (number(mesh.counts.shells)) (number(mesh.counts.closed_shells))
                (number(mesh.counts.boundary_edges)) (number(mesh.counts.non_manifold_edges))
                (number(mesh.counts.misoriented_edges)) (number(mesh.counts.inside_out_shells))
                td { (text::volume(mesh.counts.signed_volume, mesh.counts.balanced)) }
                td.word { (mesh.verdict.name()) }
            }
        }
    };
    // The worst first, if there are too many.
    let mut order: Vec<usize> = (0..report.meshes.len()).collect();
    if order.len() > MESHES {
        order.sort_by_key(|&index| std::cmp::Reverse(report.meshes[index].verdict));
    }
    html! {
        div.scroll {
            table {
                thead { tr {
                    th { "mesh" } th { "vertices" } th { "welded" } th { "faces" } th { "edges" } th { "shells" }
                    th { "closed" } th { "boundary" } th { "non-manifold" } th { "misoriented" } th { "inside out" }
                    th { "volume" } th.word { "verdict" }
                } }
                tbody { @for &index in order.iter().take(MESHES) { (of_mesh(index, &report.meshes[index])) } }
            }
        }
        @if order.len() > MESHES {
            p.faint { "The " (MESHES) " worst of " (grouped(order.len() as f64)) " meshes are listed." }
        }
    }
}

/// The defects of one kind as a table.
fn kind_of_defect(kind: DefectKind, of_kind: &OfKind, report: &FileReport) -> Markup {
    let several = report.meshes.len() > 1;
    let decimals = decimals(of_kind);
    let number = |x: f64| match decimals {
        Some(decimals) => format!("{x:.decimals$}"),
        None => significant(x),
    };
    let has_length = of_kind.rows.iter().any(|row| row.place.length.is_some());
    html! {
        section data-kind=(kind.name()) {
            h3 { (swatch(kind)) (many(kind, of_kind)) " " span.faint { (severity(kind)) } }
            p { "Effect on the shadow: " (kind.effect()) "." }
            div.scroll { table {
                thead { tr {
                    th { "x" } th { "y" } th { "z" }
                    @if has_length { th { "length" } }
                    th.word { "faces" }
                    @if several { th.word { "mesh" } }
                } }
                tbody {
                    @for row in &of_kind.rows {
                        tr.defect {
                            @for x in row.place.position { td { (number(f64::from(x))) } }
                            @if has_length { td { (row.place.length.map_or(String::new(), number)) } }
                            td.word { (place(row, report)) }
                            @if several { td.word { (label(row.mesh, &report.meshes[row.mesh])) } }
                        }
                    }
                }
            } }
            @if of_kind.count > of_kind.rows.len() {
                p.faint {
                    "The first " (grouped(of_kind.rows.len() as f64)) " are listed; "
                    @if !of_kind.complete { "at least " }
                    (grouped((of_kind.count - of_kind.rows.len()) as f64)) " more are not."
                }
            }
        }
    }
}

/// The decimals that give the largest coordinate of a table six digits; `None` where that makes no readable
/// column.
fn decimals(of_kind: &OfKind) -> Option<usize> {
    let coordinates = of_kind.rows.iter().flat_map(|row| row.place.position).map(|x| f64::from(x).abs());
    let lengths = of_kind.rows.iter().filter_map(|row| row.place.length);
    match coordinates.chain(lengths).fold(0.0, f64::max) {
        0.0 => Some(0),
        most if (1e-3..1e7).contains(&most) => Some((5 - most.log10().floor() as i32).clamp(0, 8) as usize),
        _ => None,
    }
}

/// The faces of a defect, where the file has them, and the name of their part.
fn place(row: &Row, report: &FileReport) -> String {
    let listed = &row.place.faces[..row.place.faces.len().min(FACES)];
    let faces: Vec<(FaceId, Origin)> = listed.iter().map(|listed| (listed.face, listed.origin)).collect();
    let more = row.place.face_count - listed.len();
    let more = if more > 0 { format!(" and {} more", grouped(more as f64)) } else { String::new() };
    let part = match &row.place.name {
        name if name.is_empty() || *name == report.meshes[row.mesh].name => String::new(),
        name => format!(", {}", short(name)),
    };
    format!("{}{more}{part}", Faces(&faces))
}

/// What the page leaves out, a sentence each.
fn limits(found: &[(DefectKind, &OfKind)], shown: &Shown) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(cells) = shown.cells {
        lines.push(format!(
            "The view shows {} triangles for the {} of the mesh: vertices in one cell of a grid of {cells} cells \
             a side are one. Defects are drawn where they are.",
            grouped(shown.triangles as f64),
            grouped(shown.of as f64)
        ));
    }
    for (kind, of_kind) in found {
        let name = kind.name().replace('_', " ");
        for (what, drawn, all) in [
            ("lines", of_kind.lines.items().len(), of_kind.line_count),
            ("dots", of_kind.spots.items().len(), of_kind.spot_count),
        ] {
            if drawn < all {
                let [drawn, all] = [drawn, all].map(|count| grouped(count as f64));
                lines.push(format!("The view draws {drawn} of {all} {what} of the kind {name}."));
            }
        }
    }
    if found.iter().any(|(_, of_kind)| of_kind.count > of_kind.rows.len()) {
        lines.push(format!(
            "The list ends after {ROWS} defects of a kind; check --json --limit N lists more."
        ));
    }
    lines
}
