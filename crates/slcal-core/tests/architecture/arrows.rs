//! Who uses whom: names are followed through re-exports to the file that defines them.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Module, Modules};

/// What a module uses.
#[derive(Default)]
pub(crate) struct Uses {
    /// Modules in which a name was looked up, those that re-export it included, the root not.
    pub(crate) modules: BTreeSet<Vec<String>>,
    /// Other files that define what is used. What is only re-exported does not count.
    pub(crate) files: BTreeSet<String>,
}

/// What every module uses, by its path.
pub(crate) fn arrows(modules: &Modules) -> BTreeMap<Vec<String>, Uses> {
    modules.iter().map(|(path, module)| (path.clone(), uses(modules, path, module))).collect()
}

fn uses(modules: &Modules, path: &[String], module: &Module) -> Uses {
    let mut uses = Uses::default();
    let mentions = |name: &str| module.mentioned.iter().any(|p| p[0] == name);
    let imported = module.imports.iter().map(|i| (&i.path, !i.exported || mentions(&i.name)));
    for (target, counts) in imported.chain(module.mentioned.iter().filter(|p| p.len() > 1).map(|p| (p, true)))
    {
        let passed = resolve(modules, path, target, 0).unwrap_or_default();
        if let Some(end) = passed.last().filter(|end| counts && modules[*end].file != module.file) {
            uses.files.insert(modules[end].file.clone());
        }
        uses.modules.extend(passed.into_iter().filter(|p| !p.is_empty()));
    }
    uses
}

/// The modules in which a path's name is looked up, the last of which defines it or is named by it. None where the path leads into
/// another crate.
fn resolve(modules: &Modules, from: &[String], path: &[String], depth: usize) -> Option<Vec<Vec<String>>> {
    let mut at = from.to_vec();
    let heads = path.iter().take_while(|name| matches!(name.as_str(), "crate" | "self" | "super")).count();
    for head in &path[..heads] {
        match head.as_str() {
            "crate" => at.clear(),
            "super" => drop(at.pop()),
            _ => {}
        }
    }
    let mut rest = &path[heads..];
    while let Some(child) = rest.first().filter(|name| modules[&at].children.contains(*name)) {
        at.push(child.clone());
        rest = &rest[1..];
    }
    let Some(name) = rest.first().filter(|name| !modules[&at].defined.contains(*name)) else {
        return Some(vec![at]);
    };
    // Imports that lead in a circle are those of another crate, such as `use image;`.
    let imports = modules[&at].imports.iter().filter(|i| depth < 16 && (i.name == *name || i.name == "*"));
    let found = imports.filter_map(|import| {
        let behind = &rest[usize::from(import.name != "*")..];
        let passed = resolve(modules, &at, &[import.path.as_slice(), behind].concat(), depth + 1)?;
        let end = passed.last()?;
        let has_it = import.name != "*" || modules[end].defined.contains(name) || end.last() == Some(name);
        has_it.then_some(passed)
    });
    match found.min_by_key(Vec::len) {
        Some(behind) => Some([vec![at], behind].concat()),
        // Made by a macro. A name alone that is not known here is one of the prelude or of another crate.
        None => (rest.len() < path.len()).then(|| vec![at]),
    }
}

/// Groups of files of which each uses, directly or by way of others, every other of its group.
pub(crate) fn circles(modules: &Modules) -> Vec<Vec<String>> {
    let mut next = BTreeMap::<String, BTreeSet<String>>::new();
    for (path, uses) in arrows(modules) {
        next.entry(modules[&path].file.clone()).or_default().extend(uses.files);
    }
    let reached: BTreeMap<&String, BTreeSet<&String>> =
        next.keys().map(|f| (f, reachable(&next, f))).collect();
    let mut circles = BTreeSet::new();
    for (file, beyond) in &reached {
        if beyond.contains(file) {
            circles.insert(
                beyond.iter().filter(|f| reached[*f].contains(file)).map(ToString::to_string).collect(),
            );
        }
    }
    circles.into_iter().collect()
}

fn reachable<'a>(next: &'a BTreeMap<String, BTreeSet<String>>, from: &'a String) -> BTreeSet<&'a String> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(file) = open.pop() {
        open.extend(next[file].iter().filter(|f| found.insert(*f)));
    }
    found
}
