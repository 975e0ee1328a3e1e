//! The tree of the nodes that a scene reaches from its roots.
//!
//! The specification wants every node of the document to have one parent at most, and roots to have none.
//! Here only what the scene reaches counts: a node stands once, below its parent in the scene if it has one
//! there. What contradicts that outside the scene is noted; what does so inside is refused.

use gltf::json::Value;

use super::document::{Document, Kind};
use super::notes::Notes;
use super::object::Object;
use crate::read::ReadError;

/// Parents and children in the scene: no node has two parents there, and none is its own ancestor.
pub(super) struct Tree {
    /// Of each node of the document; none of those that the scene does not reach.
    pub(super) children: Vec<Vec<usize>>,
    /// In the order of the scene.
    pub(super) roots: Vec<usize>,
}

impl Tree {
    pub(super) fn new(document: &Document, notes: &Notes) -> Result<Self, ReadError> {
        let count = document.list(Kind::Node).len();
        let listed = listed_roots(document, notes)?;
        // Without a list, every node is reached; the roots are those without a parent.
        let start = listed.clone().unwrap_or_else(|| (0..count).collect());
        let mut tree = Self { children: vec![Vec::new(); count], roots: Vec::new() };
        let (reached, parent) = tree.reach(document, &start, notes)?;
        tree.roots = start.iter().copied().filter(|&root| parent[root].is_none()).collect();
        for &root in &start {
            match parent[root] {
                Some(above) if listed.is_some() => {
                    let why = || format!("node {root} is a child of node {above}, and stands once, below it");
                    notes.because("root that has a parent in the scene", "scene", why);
                }
                _ => {}
            }
        }
        note_outside(document, &reached, &parent, notes);

        // With one parent per node, one that no root leads to is on a cycle or below one.
        let mut led_to = vec![false; count];
        let mut pending = tree.roots.clone();
        while let Some(node) = pending.pop() {
            led_to[node] = true;
            pending.extend(&tree.children[node]);
        }
        if let Some(mut node) = (0..count).find(|&node| reached[node] && !led_to[node]) {
            for _ in 0..count {
                node = parent[node].expect("what no root leads to has a parent"); // ends on the cycle
            }
            return Err(document.item(Kind::Node, node)?.error("is its own ancestor"));
        }
        Ok(tree)
    }

    /// Fills in the children of every node that `start` leads to: which those are, and their parents.
    fn reach(
        &mut self,
        document: &Document,
        start: &[usize],
        notes: &Notes,
    ) -> Result<(Vec<bool>, Vec<Option<usize>>), ReadError> {
        let count = self.children.len();
        let (mut reached, mut parent) = (vec![false; count], vec![None; count]);
        start.iter().for_each(|&root| reached[root] = true);
        let mut pending = start.to_vec();
        while let Some(index) = pending.pop() {
            let node = document.item(Kind::Node, index)?;
            for child in node.links("children", document, Kind::Node)? {
                match parent[child] {
                    None => {
                        parent[child] = Some(index);
                        self.children[index].push(child);
                        if !std::mem::replace(&mut reached[child], true) {
                            pending.push(child);
                        }
                    }
                    Some(other) if other == index => {
                        notes.add("child listed twice stands once", &node.place);
                    }
                    Some(other) => {
                        let (first, second) = (other.min(index), other.max(index));
                        let problem = format!("has two parents in the scene, node {first} and node {second}");
                        return Err(document.item(Kind::Node, child)?.error(problem));
                    }
                }
            }
        }
        Ok((reached, parent))
    }
}

/// The nodes that the default scene lists, or else the first one, each once; `None` if there are no scenes.
fn listed_roots(document: &Document, notes: &Notes) -> Result<Option<Vec<usize>>, ReadError> {
    let scenes = document.list(Kind::Scene).len();
    let what = "default scene that does not exist passed over";
    let stated = document.object().link_or_note("scene", document, Kind::Scene, what, notes);
    let Some(index) = stated.or((scenes > 0).then_some(0)) else { return Ok(None) };
    let scene = document.item(Kind::Scene, index)?;
    notes.add_many("read, the other scenes left out", &scene.place, usize::from(scenes > 1));
    let mut seen = vec![false; document.list(Kind::Node).len()];
    let mut roots = scene.links("nodes", document, Kind::Node)?;
    let all = roots.len();
    roots.retain(|&root| !std::mem::replace(&mut seen[root], true));
    notes.add_many("root listed twice stands once", &scene.place, all - roots.len());
    Ok(Some(roots))
}

/// Notes nodes outside the scene that claim a node inside for their child: they do not move it.
fn note_outside(document: &Document, reached: &[bool], parent: &[Option<usize>], notes: &Notes) {
    for (index, node) in document.list(Kind::Node).iter().enumerate().filter(|&(index, _)| !reached[index]) {
        let children = node.get("children").and_then(Value::as_array).into_iter().flatten();
        let inside =
            |child: &Value| Some(child.as_u64()? as usize).filter(|&child| reached.get(child) == Some(&true));
        for child in children.filter_map(inside) {
            let why = || format!("node {index} is not in the scene, and does not move it");
            let what = match parent[child] {
                None => "root with a parent outside the scene",
                Some(_) => "node with a second parent outside the scene",
            };
            notes.because(what, &Object::place(Kind::Node, child), why);
        }
    }
}
