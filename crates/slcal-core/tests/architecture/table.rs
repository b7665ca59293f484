//! The table of `docs/architecture.md` that says which module may use which.

use crate::arrows::arrows;
use crate::source::Modules;

pub(crate) struct Row {
    pub(crate) modules: Vec<String>,
    pub(crate) uses: Vec<String>,
}

/// The rows below a heading of the page: the first column names modules, the last what they may use.
pub(crate) fn rows(page: &str, heading: &str) -> Vec<Row> {
    let below = page.split_once(&format!("\n{heading}\n")).unwrap_or_else(|| panic!("no {heading:?}")).1;
    let lines = below.lines().skip_while(|l| !l.starts_with('|')).take_while(|l| l.starts_with('|'));
    let names = |cell: &str| cell.split('`').skip(1).step_by(2).map(Into::into).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
        Row { modules: names(cells[0]), uses: names(cells[cells.len() - 1]) }
    };
    lines.skip(2).map(row).collect()
}

/// What does not agree between the table and the children of the module `within`. Everybody may use what stands in the first row.
pub(crate) fn disagreements(table: &[Row], modules: &Modules, within: &[String]) -> Vec<String> {
    let mut wrong = order(table);
    let listed: Vec<&String> = table.iter().flat_map(|r| &r.modules).collect();
    let children = &modules[within].children;
    wrong.extend(children.iter().filter(|c| !listed.contains(c)).map(|c| format!("{c} is not in the table")));
    wrong.extend(listed.iter().filter(|l| !children.contains(**l)).map(|l| format!("there is no {l}")));

    let child = |path: &[String]| path.strip_prefix(within).and_then(|p| p.first()).cloned();
    let mut unused: Vec<(&Row, &String)> =
        table.iter().flat_map(|r| r.uses.iter().map(move |u| (r, u))).collect();
    for (path, uses) in arrows(modules) {
        let Some(row) = child(&path).and_then(|c| table.iter().find(|r| r.modules.contains(&c))) else {
            continue;
        };
        for used in uses.modules.iter().filter_map(|m| child(m)) {
            unused.retain(|(of, name)| !std::ptr::eq(*of, row) || **name != used);
            if ![&row.modules, &row.uses, &table[0].modules].iter().any(|free| free.contains(&used)) {
                wrong.push(format!("{} uses {used}", modules[&path].file));
            }
        }
    }
    wrong.sort();
    wrong.dedup();
    wrong.extend(unused.iter().map(|(row, name)| format!("{} does not use {name}", row.modules.join(", "))));
    wrong
}

/// A row uses only rows above it.
fn order(table: &[Row]) -> Vec<String> {
    let mut wrong = Vec::new();
    for (i, row) in table.iter().enumerate() {
        let above = |name: &String| table[..i].iter().any(|r| r.modules.contains(name));
        wrong.extend(
            row.uses
                .iter()
                .filter(|u| !above(u))
                .map(|u| format!("{u} does not stand above {}", row.modules[0])),
        );
    }
    wrong
}
