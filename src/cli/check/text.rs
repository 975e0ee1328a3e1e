//! The crack report as text: the verdict first, and readable for hundreds of meshes.

use std::fmt::{self, Display};

use umbrage::check::{Counts, DefectKind, NearMiss, Requirement, Standing, Verdict};
use umbrage::mesh::{FaceId, Origin};

use super::{FileReport, MeshReport, Place};
use crate::cli::color::Painter;
use crate::cli::output::{Table, brief, counted, plain, short, significant};

/// Width of a table. Its names are cut for it; names of files, which are behind the numbers, are not.
const COLUMNS: usize = 80;

/// How many face numbers are printed per defect.
const FACES_PRINTED: usize = 6;

/// One file's report, for printing.
pub(super) struct Report<'a> {
    pub(super) report: &'a FileReport,
    pub(super) limit: usize,
    pub(super) painter: Painter,
}

impl Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let format = self.report.format.map_or("generated", |format| format.name());
        writeln!(f, "{} ({format})", plain(&self.report.file.to_string_lossy()))?;
        self.counts(f)?;
        self.verdict(f)?;
        self.frames(f)?;
        self.rounding(f)?;
        for kind in DefectKind::ALL {
            self.defects(f, kind)?;
        }
        self.remedies(f)?;
        self.shells(f)
    }
}

impl Report<'_> {
    /// The verdict, how rounding may have made the defects, and what would close them: a line each, as in the
    /// report.
    pub(super) fn verdict_lines(&self) -> Vec<String> {
        struct Printed<F>(F);
        impl<F: Fn(&mut fmt::Formatter<'_>) -> fmt::Result> Display for Printed<F> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0(f)
            }
        }
        let text = Printed(|f: &mut fmt::Formatter<'_>| {
            self.verdict(f)?;
            self.rounding(f)?;
            self.remedies(f)
        });
        let text = text.to_string();
        text.lines().map(str::trim).filter(|line| !line.is_empty()).map(str::to_owned).collect()
    }

    /// A row for each listed mesh, and the total.
    fn counts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let meshes = &self.report.meshes;
        let Some(total) = self.report.total() else { return Ok(()) };
        let mut table = Table::new(&[
            "mesh",
            "vertices",
            "welded",
            "faces",
            "edges",
            "shells",
            "closed",
            "euler",
            "boundary",
            "non-\nmanifold",
            "mis-\noriented",
            "volume",
            "",
        ])
        .within(COLUMNS);
        let listed = self.listed();
        for &index in &listed {
            let mesh = &meshes[index];
            let vertices = [mesh.vertices, mesh.welded_vertices];
            table.row(self.row(column_label(index, mesh), vertices, &mesh.counts, mesh.verdict));
        }
        if meshes.len() > 1 {
            let vertices =
                [self.report.sum(|mesh| mesh.vertices), self.report.sum(|mesh| mesh.welded_vertices)];
            let name = format!("all {} meshes", meshes.len());
            table.row(self.row(name, vertices, &total, self.report.verdict()));
        }
        writeln!(f, "{table}")?;
        let hidden = meshes.len() - listed.len();
        if hidden > 0 {
            let all = meshes.iter().filter(|mesh| !mesh.sound()).count();
            let shown = listed.iter().filter(|&&index| !meshes[index].sound()).count();
            let hidden = counted(hidden, "mesh", "meshes");
            match all - shown {
                0 => writeln!(f, "  {hidden} not listed, all sound")?,
                bad if total.undecided_shells > 0 => {
                    writeln!(f, "  {hidden} not listed, {bad} of them not proven sound")?;
                }
                cracked => writeln!(f, "  {hidden} not listed, {cracked} of them cracked")?,
            }
        }
        let unused = self.report.sum(|mesh| mesh.unreferenced_vertices);
        if unused > 0 {
            let unused = counted(unused, "vertex belongs", "vertices belong");
            writeln!(f, "  {unused} to no face")?;
        }
        for remark in total.remarks() {
            writeln!(f, "  {remark}")?;
        }
        Ok(())
    }

    /// All meshes if they are few, otherwise the worst, in the order of the file.
    fn listed(&self) -> Vec<usize> {
        let meshes = &self.report.meshes;
        if meshes.len() <= self.limit.max(1) {
            return (0..meshes.len()).collect();
        }
        let badness = |index: &usize| {
            let counts = &meshes[*index].counts;
            counts.boundary_edges
                + counts.non_manifold_edges
                + counts.misoriented_edges
                + counts.inside_out_shells
        };
        let mut bad: Vec<usize> = (0..meshes.len()).filter(|&index| !meshes[index].sound()).collect();
        bad.sort_by_key(|index| std::cmp::Reverse(badness(index)));
        bad.truncate(self.limit);
        bad.sort_unstable();
        bad
    }

    fn verdict(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let report = self.report;
        let Some(total) = report.total() else {
            return writeln!(f, "  {}", self.painted(&Counts::default().summary(), Verdict::Empty));
        };
        let (meshes, requirements) = (report.meshes.len(), &report.requirements);
        if report.verdict() == Verdict::Empty || total.is_empty() {
            let empty = report.meshes.iter().filter(|mesh| mesh.counts.is_empty()).count();
            return match empty == meshes {
                true => writeln!(f, "  {}", self.painted(&total.summary(), Verdict::Empty)),
                false => {
                    let word = self.painter.verdict(Verdict::Empty, "empty");
                    writeln!(f, "  {word}: {empty} of {meshes} meshes have no faces to check")
                }
            };
        }
        let properties = requirements.iter().copied().filter(|&asked| asked != Requirement::NotEmpty);
        let mut held = Vec::new();
        for asked in properties {
            let of = |mesh: &MeshReport| asked.standing(&mesh.counts);
            match report.standing(asked) {
                Standing::Holds => held.push(asked),
                worst => {
                    let bad = report.meshes.iter().filter(|mesh| of(mesh) == worst);
                    let counts: Vec<Counts> = bad.map(|mesh| mesh.counts).collect();
                    self.unmet(f, asked, worst, &counts)?;
                }
            }
        }
        if report.verdict() != Verdict::Sound {
            return Ok(());
        }
        let who = if meshes == 1 { "the mesh" } else { "every mesh" };
        let sound = self.painter.verdict(Verdict::Sound, "sound");
        if let Some(at) = held.iter().position(|&asked| asked == Requirement::Sound) {
            held.remove(at);
            writeln!(f, "  {sound}: {who} is watertight, and no shell is inside out")?;
        }
        let properties: Vec<&str> = held.into_iter().map(Requirement::property).collect();
        match properties.split_last() {
            None => Ok(()),
            Some((last, [])) => writeln!(f, "  {sound}: {who} is {last}"),
            Some((last, first)) => writeln!(f, "  {sound}: {who} is {} and {last}", first.join(", ")),
        }
    }

    /// What the other poses have.
    fn frames(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.frames.as_ref().map_or(Ok(()), |frames| frames.print(f, self.painter))
    }

    /// A property that some meshes do not have, or are not proven to have.
    fn unmet(
        &self,
        f: &mut fmt::Formatter<'_>,
        asked: Requirement,
        standing: Standing,
        counts: &[Counts],
    ) -> fmt::Result {
        let meshes = self.report.meshes.len();
        let who = match (counts.len(), meshes) {
            (_, 1) => "the mesh".to_owned(),
            (bad, _) => format!("{bad} of {meshes} meshes"),
        };
        let (is, is_not) = if counts.len() > 1 { ("are", "are not") } else { ("is", "is not") };
        let Some(total) = Counts::total(counts.iter().copied()) else { return Ok(()) };
        let property = asked.property();
        match standing {
            Standing::Undecided if asked == Requirement::Sound => {
                let shells = counted(total.undecided_shells, "shell", "shells");
                writeln!(
                    f,
                    "  {}: {who} {is} watertight, but nesting not decided within the limit: \
                     {shells} may be inside out",
                    self.painter.verdict(Verdict::NotProven, "not proven sound")
                )
            }
            Standing::Undecided => {
                let word = self.painter.verdict(Verdict::NotProven, "not proven");
                writeln!(f, "  {word}: {who} {is} not proven {property}, since the search was not finished")
            }
            _ => {
                let reasons = asked.reasons(&total);
                let colon = if reasons.is_empty() { "" } else { ": " };
                let word = self.painter.verdict(Verdict::Cracked, "cracked");
                writeln!(f, "  {word}: {who} {is_not} {property}{colon}{reasons}")
            }
        }
    }

    /// A line with the verdict before its colon.
    fn painted(&self, line: &str, verdict: Verdict) -> String {
        match line.split_once(':') {
            Some((word, rest)) => format!("{}:{rest}", self.painter.verdict(verdict, word)),
            None => line.to_owned(),
        }
    }

    /// That rounding may be what made the defects.
    fn rounding(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let defects = self.report.meshes.iter().any(|mesh| !mesh.defects.is_empty());
        match self.report.rounding.filter(|_| defects) {
            None => Ok(()),
            Some(moved) => writeln!(
                f,
                "  32-bit coordinates moved a vertex by up to {}: defects of that size come from the rounding",
                significant(moved)
            ),
        }
    }

    /// One kind of defect over all meshes: number, effect, and the first locations.
    fn defects(&self, f: &mut fmt::Formatter<'_>, kind: DefectKind) -> fmt::Result {
        let found = |mesh: &MeshReport| mesh.defects.iter().position(|found| found.kind == kind);
        let with: Vec<_> = self
            .report
            .meshes
            .iter()
            .enumerate()
            .filter_map(|(index, mesh)| Some((index, mesh, &mesh.defects[found(mesh)?])))
            .collect();
        let count: usize = with.iter().map(|(.., found)| found.count).sum();
        if count == 0 {
            return Ok(());
        }
        let least = if with.iter().all(|(.., found)| found.complete) { "" } else { "at least " };
        write!(f, "\n  {}: {least}{count}", kind.name())?;
        if self.report.meshes.len() > 1 {
            write!(f, " in {} of {} meshes", with.len(), self.report.meshes.len())?;
        }
        writeln!(f, "\n    effect on the shadow: {}", kind.effect())?;
        let places =
            with.iter().flat_map(|&(index, mesh, found)| found.at.iter().map(move |at| (index, mesh, at)));
        let mut printed = 0;
        for (index, mesh, place) in places.take(self.limit) {
            let mesh = (self.report.meshes.len() > 1).then(|| label(index, mesh));
            writeln!(f, "    {}", At { place, mesh })?;
            printed += 1;
        }
        if count > printed {
            writeln!(f, "    {least}{} more", count - printed)?;
        }
        Ok(())
    }

    /// What a weld within a small distance would close.
    fn remedies(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let closing = |mesh: &MeshReport| mesh.near_miss.iter().any(|near| near.edges > 0);
        let mut meshes = self.report.meshes.iter().enumerate().filter(|(_, mesh)| closing(mesh));
        for (index, mesh) in meshes.by_ref().take(self.limit) {
            let of = if self.report.meshes.len() > 1 {
                format!(" of {}", label(index, mesh))
            } else {
                String::new()
            };
            for near in NearMiss::steps(&mesh.near_miss) {
                writeln!(f, "\n  {}{of}", near.hint(mesh.counts.boundary_edges))?;
            }
        }
        let more = meshes.count();
        if more > 0 {
            writeln!(f, "  a weld would close edges of {}", counted(more, "more mesh", "more meshes"))?;
        }
        let open = self.report.meshes.iter().filter(|mesh| mesh.counts.boundary_edges > 0).count();
        if self.report.joinable && open > 1 {
            writeln!(
                f,
                "\n  --scope scene looks at the file as one mesh, which closes boundary edges where meshes meet"
            )?;
        }
        Ok(())
    }

    fn row(
        &self,
        name: String,
        [vertices, welded]: [usize; 2],
        counts: &Counts,
        verdict: Verdict,
    ) -> Vec<String> {
        vec![
            name,
            vertices.to_string(),
            welded.to_string(),
            counts.faces.to_string(),
            counts.edges.to_string(),
            counts.shells.to_string(),
            counts.closed_shells.to_string(),
            counts.euler_characteristic.to_string(),
            counts.boundary_edges.to_string(),
            counts.non_manifold_edges.to_string(),
            counts.misoriented_edges.to_string(),
            volume(counts.signed_volume, counts.balanced),
            self.painter.verdict(verdict, verdict.name()),
        ]
    }

    fn shells(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let total = self.report.sum(|mesh| mesh.counts.shells);
        if total <= 1 || self.report.meshes.len() > self.limit.max(1) {
            return Ok(());
        }
        let mut table =
            Table::new(&["shell", "first face", "faces", "euler", "genus", "depth", "volume", ""])
                .within(COLUMNS);
        let shells = self.report.meshes.iter().enumerate().flat_map(|(index, mesh)| {
            mesh.shell_list.iter().enumerate().map(move |shell| (index, mesh, shell))
        });
        let mut listed = 0;
        for (index, mesh, (number, shell)) in shells.take(self.limit) {
            let name = if self.report.meshes.len() > 1 {
                format!("{} {number}", column_label(index, mesh))
            } else {
                number.to_string()
            };
            table.row(vec![
                name,
                Faces(&[(shell.first_face, mesh.shell_origins[number])]).to_string(),
                shell.faces.to_string(),
                shell.euler_characteristic.to_string(),
                shell.genus.map_or("-".into(), |genus| genus.to_string()),
                if shell.depth_known { shell.depth.to_string() } else { "-".into() },
                volume(shell.signed_volume, shell.balanced),
                shell.state().into(),
            ]);
            listed += 1;
        }
        if listed > 0 {
            writeln!(f, "\n{table}")?;
        }
        if total > listed {
            writeln!(f, "  {}", counted(total - listed, "more shell", "more shells"))?;
        }
        Ok(())
    }
}

/// The name of a kind of defect in words, singular or plural.
pub(super) fn noun(kind: DefectKind, count: usize) -> String {
    let words = kind.name().replace('_', " ");
    match words.strip_suffix("vertex") {
        _ if count == 1 => words,
        Some(first) => format!("{first}vertices"),
        None => format!("{words}s"),
    }
}

/// An open surface has no volume.
pub(super) fn volume(signed: f64, balanced: bool) -> String {
    if balanced { significant(signed) } else { "-".to_owned() }
}

pub(super) fn label(index: usize, mesh: &MeshReport) -> String {
    if mesh.name.is_empty() { format!("mesh {index}") } else { short(&mesh.name) }
}

/// The same for a table.
fn column_label(index: usize, mesh: &MeshReport) -> String {
    if mesh.name.is_empty() { format!("mesh {index}") } else { brief(&mesh.name) }
}

/// One defect on a line.
struct At<'a> {
    place: &'a Place,
    /// Where there are several.
    mesh: Option<String>,
}

impl Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.place.position.map(|x| significant(f64::from(x)));
        write!(f, "at {x}, {y}, {z}")?;
        if let Some(length) = self.place.length {
            write!(f, ", length {}", significant(length))?;
        }
        if self.place.face_count > 0 {
            write!(f, ", {}", FacesOf(self.place))?;
        }
        if let Some(mesh) = &self.mesh {
            write!(f, ", {mesh}")?;
        }
        let name = short(&self.place.name);
        // The name of a mesh split off by part ends in the name of the part.
        let said = self.mesh.as_ref().is_some_and(|mesh| {
            mesh.strip_suffix(&name).is_some_and(|rest| rest.is_empty() || rest.ends_with(" / "))
        });
        if !name.is_empty() && !said {
            write!(f, ", {name}")?;
        }
        Ok(())
    }
}

/// A defect in the name of its mark: its kind, its faces, and the part or mesh that they are in.
pub(super) struct Title<'a> {
    pub(super) kind: DefectKind,
    pub(super) place: &'a Place,
}

impl Display for Title<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.place.position.map(|x| significant(f64::from(x)));
        match self.place.face_count {
            0 => write!(f, "{}: at {x}, {y}, {z}", self.kind)?,
            _ => write!(f, "{}: {}", self.kind, FacesOf(self.place))?,
        }
        match short(&self.place.name) {
            name if name.is_empty() => Ok(()),
            name => write!(f, ", {name}"),
        }
    }
}

/// The first faces of a defect: "faces 3 4 (polygon 2, line 9) and 7 more".
struct FacesOf<'a>(&'a Place);

impl Display for FacesOf<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(place) = self;
        let listed = &place.faces[..place.faces.len().min(FACES_PRINTED)];
        let faces: Vec<(FaceId, Origin)> = listed.iter().map(|listed| (listed.face, listed.origin)).collect();
        write!(f, "{} {}", if place.face_count == 1 { "face" } else { "faces" }, Faces(&faces))?;
        match place.face_count - listed.len() {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}

/// The numbers of faces, and where the file has them if that is another number: "3 4 (polygon 2, line 9)".
pub(super) struct Faces<'a>(pub(super) &'a [(FaceId, Origin)]);

impl Display for Faces<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joined = |numbers: &[u64]| numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(" ");
        let faces: Vec<u64> = self.0.iter().map(|(face, _)| u64::from(face.0)).collect();
        let polygons: Vec<u64> = self.0.iter().map(|(_, origin)| u64::from(origin.polygon)).collect();
        let lines: Vec<u64> = self.0.iter().filter_map(|(_, origin)| origin.line).collect();
        write!(f, "{}", joined(&faces))?;
        let named = [("polygon", if polygons == faces { vec![] } else { polygons }), ("line", lines)];
        let named =
            named.into_iter().filter(|(_, numbers)| !numbers.is_empty()).map(|(noun, mut numbers)| {
                // The triangles of one polygon are neighbors.
                numbers.dedup();
                format!("{noun}{} {}", if numbers.len() == 1 { "" } else { "s" }, joined(&numbers))
            });
        match named.collect::<Vec<_>>() {
            named if named.is_empty() => Ok(()),
            named => write!(f, " ({})", named.join(", ")),
        }
    }
}
