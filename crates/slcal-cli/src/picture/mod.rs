//! Pictures of what was found and how well it fits. `drawing` draws upon a photograph; `sheet`, `fit`, `stripes` and `expected`
//! say what is drawn, `tiles` puts several on one sheet, `surface` shows a cloud.

mod drawing;
pub(crate) mod expected;
pub(crate) mod fit;
mod light;
mod magnify;
pub(crate) mod sheet;
pub(crate) mod stripes;
pub(crate) mod surface;
pub(crate) mod tiles;

pub(crate) use drawing::Drawing;
pub(crate) use light::as_seen;

/// The name of a file without its folders, which would fill the headline.
pub(crate) fn short(name: &str) -> &str {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if last.is_empty() { name } else { last }
}

/// The name under which a photograph stands among others: with its folders where it takes them to tell.
pub(crate) fn name_among<'a>(names: &[&'a str], i: usize) -> &'a str {
    let Some(&name) = names.get(i) else { return "photograph" };
    let unique = names.iter().enumerate().all(|(j, other)| j == i || short(other) != short(name));
    if unique { short(name) } else { name }
}
