//! From a file to welded meshes: shared by every command that reads a mesh.

use std::convert::Infallible;
use std::path::Path;

use umbrage::check::Screen;
use umbrage::geom::Aabb;
use umbrage::mesh::{Mesh, MeshError, Weld, weld_in_place};
use umbrage::read::Format;
use umbrage::scene::{Lamp, Material, OwnSpace, Pattern, PlacedPart, Scene, Scope};
use umbrage::view::Up;

use super::error::Failure;
use super::files;
use super::output;
use super::progress::Progress;
use super::view::Cameras;

/// How vertices are merged and what counts as one mesh.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct MeshArgs {
    /// Which vertices are the same: `exact` (equal positions, bit for bit), `none` (the file's own indices),
    /// or a distance in mesh units [default: exact]
    ///
    /// Raise the distance when a report speaks of near-miss seams: nothing moves farther than that. Where a
    /// file has frames (md2), vertices are one only if they coincide in all frames; in a pose, only if they
    /// coincide at rest and the clip moves them alike.
    #[arg(long, value_name = "exact|none|DIST", value_parser = parse_weld, allow_negative_numbers = true)]
    weld: Option<Weld>,

    /// What is welded and counted as one mesh [default: mesh]
    #[arg(long, value_enum)]
    scope: Option<ScopeArg>,

    /// Load only what has such a name: a node, mesh, part or material; may be repeated [default: everything]
    ///
    /// `*` stands for any characters, `?` for one; case counts. For example: --only 'Tree*' --only Ground.
    #[arg(long, value_name = "PATTERN", value_parser = parse_pattern)]
    only: Vec<Pattern>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ScopeArg {
    /// Each mesh instance, where the scene places it
    Mesh,
    /// Each part of a mesh (primitive, group) separately
    Primitive,
    /// The whole file; for solids that are stored in pieces
    Scene,
}

impl From<ScopeArg> for Scope {
    fn from(scope: ScopeArg) -> Self {
        match scope {
            ScopeArg::Mesh => Self::Mesh,
            ScopeArg::Primitive => Self::Primitive,
            ScopeArg::Scene => Self::Scene,
        }
    }
}

pub(crate) fn parse_pattern(text: &str) -> Result<Pattern, Infallible> {
    Ok(Pattern::new(text))
}

pub(crate) fn parse_weld(text: &str) -> Result<Weld, String> {
    match text {
        "exact" => Ok(Weld::Exact),
        "none" => Ok(Weld::None),
        _ => match text.parse::<f32>() {
            Ok(distance) if distance > 0.0 && distance.is_finite() => Ok(Weld::Within(distance)),
            _ => Err("write exact, none, or a distance above 0 in mesh units".to_owned()),
        },
    }
}

/// What a file holds, baked into world space but not welded yet.
#[derive(Debug)]
pub(crate) struct Baked {
    pub(crate) format: Option<Format>,
    pub(crate) up: Up,
    /// One for each scope.
    pub(crate) meshes: Vec<Mesh>,
    pub(crate) lights: Vec<Lamp>,
    pub(crate) cameras: Cameras,
    pub(crate) materials: Vec<Material>,
}

/// One mesh after welding, and what welding did.
#[derive(Debug)]
pub(crate) struct WeldedMesh {
    pub(crate) mesh: Mesh,
    /// How many vertices there were before.
    pub(crate) vertices: usize,
    /// How many of those no face uses.
    pub(crate) unreferenced: usize,
}

impl MeshArgs {
    /// Reads and bakes a file, as it is stored. What the reader has to say goes to standard error.
    pub(crate) fn read(&self, file: &Path) -> Result<Baked, Failure> {
        self.baked(self.chosen(read_whole(file)?, file)?, file)
    }

    /// Bakes a whole scene without what is invisible by its material: the meshes that cast, and the meshes
    /// that only receive, which match `no_cast`.
    pub(crate) fn visible(
        &self,
        whole: Scene,
        file: &Path,
        no_cast: &[Pattern],
    ) -> Result<(Baked, Vec<Mesh>), Failure> {
        let mut scene = self.chosen(whole, file)?;
        leave_out_invisible(&mut scene, file)?;
        if no_cast.is_empty() {
            return Ok((self.baked(scene, file)?, Vec::new()));
        }
        require_matches(&scene, "--no-cast", no_cast).map_err(|failure| failure.in_file(file))?;
        let mut receivers = scene.clone();
        let split = scene
            .retain(|part| !matches_any(part, no_cast))
            .and_then(|()| receivers.retain(|part| matches_any(part, no_cast)));
        split.map_err(|error| Failure::new(error, "leave out --no-cast").in_file(file))?;
        Ok((self.baked(scene, file)?, self.bake(receivers, file)?))
    }

    /// What of a scene is asked for. What the reader has to say goes to standard error.
    pub(crate) fn chosen(&self, mut scene: Scene, file: &Path) -> Result<Scene, Failure> {
        for note in &scene.notes {
            output::say(format_args!("note: {}: {}", file.display(), output::plain(note)));
        }
        retain_only(&mut scene, &self.only).map_err(|failure| failure.in_file(file))?;
        let moves = scene.placing_moves();
        if moves > 0.0 {
            output::say(format_args!(
                "note: {}: 32-bit coordinates are too coarse so far from the origin: placing moves a vertex by {}",
                file.display(),
                output::significant(moves)
            ));
        }
        let frames = scene.meshes.iter().map(|mesh| mesh.frames().len()).max().unwrap_or(0);
        if frames > 0 && self.weld_rule() != Weld::None {
            output::say(format_args!(
                "note: {}: {} frames; vertices are one only where they coincide in all of them",
                file.display(),
                frames + 1 // the mesh itself is the first one
            ));
        }
        Ok(scene)
    }

    /// The meshes of a scene as the file stores them; with `--scope scene`, as the scene places them.
    pub(crate) fn own_spaces(&self, scene: Scene, file: &Path) -> Result<Vec<OwnSpace>, Failure> {
        scene.in_own_space(self.scope().into()).map_err(|error| too_far(&error, file))
    }

    fn baked(&self, mut scene: Scene, file: &Path) -> Result<Baked, Failure> {
        let (format, up) = (scene.format, scene.up);
        let (lights, cameras) = (std::mem::take(&mut scene.lamps), Cameras::take(&mut scene));
        let materials = std::mem::take(&mut scene.materials);
        Ok(Baked { format, up, meshes: self.bake(scene, file)?, lights, cameras, materials })
    }

    /// Whether a part is asked for, and seen: what [`leave_out_invisible`] leaves of what is chosen.
    pub(crate) fn shows(&self, part: &PlacedPart<'_>) -> bool {
        let asked = self.only.is_empty() || matches_any(part, &self.only);
        asked && !part.material.is_some_and(Material::is_invisible)
    }

    /// Whether each part becomes a mesh of its own.
    pub(crate) fn splits_parts(&self) -> bool {
        self.scope() == ScopeArg::Primitive
    }

    pub(crate) fn bake(&self, scene: Scene, file: &Path) -> Result<Vec<Mesh>, Failure> {
        scene.bake(self.scope().into()).map_err(|error| too_far(&error, file))
    }

    /// Whether a file may be split into several meshes.
    pub(crate) fn is_below_scene(&self) -> bool {
        self.scope() != ScopeArg::Scene
    }

    /// Which vertices are the same.
    pub(crate) fn weld_rule(&self) -> Weld {
        self.weld.unwrap_or(Weld::Exact)
    }

    /// Sets which vertices are the same, unless the command line says so.
    pub(crate) fn weld_unless_told(&mut self, weld: Weld) {
        self.weld.get_or_insert(weld);
    }

    fn scope(&self) -> ScopeArg {
        self.scope.unwrap_or(ScopeArg::Mesh)
    }

    /// Sets what is one mesh, unless the command line says so.
    pub(crate) fn scope_unless_told(&mut self, scope: ScopeArg) {
        self.scope.get_or_insert(scope);
    }

    /// Welds one mesh, in its own memory.
    pub(crate) fn weld(&self, mesh: Mesh) -> WeldedMesh {
        let vertices = mesh.vertex_count();
        let welded = weld_in_place(mesh, self.weld_rule());
        let unreferenced = welded.unreferenced();
        WeldedMesh { mesh: welded.mesh, vertices, unreferenced }
    }

    /// Whether a mesh would be balanced once it is welded, with the probability of error of [`Screen`];
    /// `None` for a weld within a distance, which cannot be decided without welding.
    pub(crate) fn screen(&self, mesh: &Mesh) -> Option<bool> {
        match self.weld_rule() {
            Weld::Exact => Some(Screen::default().positions(mesh)),
            Weld::None => Some(Screen::default().indices(mesh.triangles())),
            Weld::Within(_) => None,
        }
    }

    /// Whether vertices are merged within a distance.
    pub(crate) fn welds_within(&self) -> bool {
        matches!(self.weld_rule(), Weld::Within(_))
    }

    /// Welds each mesh for itself and joins them into one that casts: no vertex is shared between two.
    pub(crate) fn joined(&self, meshes: Vec<Mesh>, file: &Path) -> Result<Mesh, Failure> {
        let mut welded: Vec<Mesh> = meshes.into_iter().map(|mesh| self.weld(mesh).mesh).collect();
        if welded.len() == 1 {
            return Ok(welded.remove(0));
        }
        Mesh::concat(&welded).map_err(|error| Failure::new(error, "split the file").in_file(file))
    }
}

/// A file as it is.
pub(crate) fn read_whole(file: &Path) -> Result<Scene, Failure> {
    let progress = Progress::spinner(format!("reading {}", file.display()));
    let scene = files::read(file);
    drop(progress);
    scene
}

/// The failure of a scene that cannot be placed.
pub(crate) fn too_far(error: &MeshError, file: &Path) -> Failure {
    Failure::new(error, "scale the model, or choose a smaller --scope").in_file(file)
}

/// Leaves out what none of the patterns matches, if there are any.
fn retain_only(scene: &mut Scene, patterns: &[Pattern]) -> Result<(), Failure> {
    require_matches(scene, "--only", patterns)?;
    let asked = |part: &PlacedPart<'_>| patterns.is_empty() || matches_any(part, patterns);
    scene.retain(asked).map_err(|error| Failure::new(error, "choose other names"))
}

/// Whether a name of `part` is as one of the patterns says.
pub(crate) fn matches_any(part: &PlacedPart<'_>, patterns: &[Pattern]) -> bool {
    part.names().any(|name| patterns.iter().any(|pattern| pattern.matches(name)))
}

/// Refuses a pattern that no name is like.
pub(crate) fn require_matches(scene: &Scene, option: &str, patterns: &[Pattern]) -> Result<(), Failure> {
    match patterns
        .iter()
        .find(|&pattern| !scene.placed_parts().any(|part| matches_any(&part, std::slice::from_ref(pattern))))
    {
        None => Ok(()),
        Some(pattern) => Err(nothing_matches(option, pattern, scene)),
    }
}

/// How many names a message lists.
const NAMES: usize = 8;

fn nothing_matches(option: &str, pattern: &Pattern, scene: &Scene) -> Failure {
    let mut names: Vec<&str> = Vec::new();
    for name in scene.placed_parts().flat_map(|part| part.names()) {
        if names.len() < NAMES && !names.contains(&name) {
            names.push(name);
        }
    }
    let problem = format!("{option} {pattern}: nothing has such a name");
    match names.len() {
        0 => Failure::new(problem, format!("leave out {option}: the file names nothing")),
        _ => {
            let names = names.into_iter().map(output::short).collect::<Vec<_>>().join(", ");
            Failure::new(problem, format!("use a name of the file, such as: {names}"))
        }
    }
}

/// Leaves out what its material makes invisible and says so; also where a texture, which is not read, may do
/// that.
pub(crate) fn leave_out_invisible(scene: &mut Scene, file: &Path) -> Result<(), Failure> {
    let of_parts = |is: fn(&Material) -> bool| {
        let mut names: Vec<&str> = Vec::new();
        for material in scene.placed_parts().filter_map(|part| part.material).filter(|material| is(material))
        {
            if names.len() <= NAMES && !names.contains(&material.name.as_str()) {
                names.push(&material.name);
            }
        }
        let more = names.len() > NAMES;
        let listed = names.iter().take(NAMES).map(|name| output::short(name)).collect::<Vec<_>>().join(", ");
        (!names.is_empty()).then(|| format!("{listed}{}", if more { ", …" } else { "" }))
    };
    let file_name = file.display();
    if let Some(names) = of_parts(Material::may_be_cut_out) {
        output::say(format_args!(
            "note: {file_name}: textures are not read: what they cut out of these materials casts: {names}"
        ));
    }
    if let Some(names) = of_parts(Material::is_invisible) {
        output::say(format_args!("note: {file_name}: left out, for these materials are invisible: {names}"));
        let visible = |part: &PlacedPart<'_>| !part.material.is_some_and(Material::is_invisible);
        let left_out = scene.retain(visible);
        return left_out.map_err(|error| Failure::new(error, "scale the model").in_file(file));
    }
    Ok(())
}

/// Says so if there is nothing to look at in a file: no faces, or none left after welding.
pub(crate) fn note_no_faces(file: &Path, mesh: &Mesh) {
    let collapsed = |corners: &&[u32; 3]| {
        corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]
    };
    note_none_left(file, mesh.face_count(), mesh.triangles().iter().filter(collapsed).count());
}

/// Says so if all of `faces` are among the `collapsed` ones.
pub(crate) fn note_none_left(file: &Path, faces: usize, collapsed: usize) {
    let file = output::plain(&file.to_string_lossy());
    match faces {
        0 => output::say(format_args!("note: {file}: there are no faces")),
        _ if faces == collapsed => {
            output::say(format_args!("note: {file}: {}", all_collapse(faces)));
        }
        _ => {}
    }
}

/// What is said where every face has two equal corners.
pub(crate) fn all_collapse(faces: usize) -> String {
    match faces {
        1 => "the only face collapses when welded".to_owned(),
        _ => format!("all {faces} faces collapse when welded"),
    }
}

/// The box around all faces.
pub(crate) fn bounds(mesh: &Mesh) -> Aabb {
    mesh.bounds().map_or(Aabb::EMPTY, |[low, high]| Aabb { low, high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::testing::shapes;

    #[test]
    fn weld_is_parsed_and_nonsense_refused() {
        assert_eq!(parse_weld("exact"), Ok(Weld::Exact));
        assert_eq!(parse_weld("none"), Ok(Weld::None));
        assert_eq!(parse_weld("1e-4"), Ok(Weld::Within(1e-4)));
        for text in ["0", "-1", "nan", "inf", "1e39", "1mm", "", "Exact"] {
            assert!(parse_weld(text).is_err(), "{text}");
        }
    }

    #[test]
    fn caster_joins_without_sharing_vertices() {
        let args = MeshArgs::default();
        let soups = vec![shapes::soup(&shapes::cube()), shapes::soup(&shapes::cube())];
        let caster = args.joined(soups, Path::new("two")).unwrap();
        assert_eq!((caster.vertex_count(), caster.face_count()), (16, 24));
    }
}
