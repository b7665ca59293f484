//! The state as each role is told it.

use std::path::Path;

use serde_json::{Value, json};

use super::access::Role;
use super::links::Links;
use crate::studio::machine::Machine;
use crate::studio::state::{State, Step};
use crate::studio::words::words;

/// What a phone needs that only sends photographs.
const FOR_CAMERAS: [&str; 10] =
    ["schema", "demo", "lan", "step", "busy", "problem", "photographs", "you", "sentence", "next"];

/// Who is told, and who else is there.
pub(super) struct Listener {
    pub(super) role: Role,
    pub(super) id: Option<u64>,
    pub(super) operating: bool,
    pub(super) displays: usize,
    pub(super) watchers: usize,
    pub(super) operators: usize,
}

pub(super) fn told(machine: &Machine, to: &Listener, links: &Links, folder: &Path) -> Value {
    let state = &machine.state;
    let said = words(state);
    let mut told = serde_json::to_value(state).unwrap_or_default();
    let trusted = matches!(to.role, Role::Operator | Role::Display);
    for (key, value) in [
        ("you", json!({ "role": to.role, "operating": to.operating, "page": to.id })),
        ("steps", steps(state)),
        ("sentence", json!(said.sentence)),
        ("next", json!(said.next)),
        ("command", json!(said.command)),
        ("others", json!({ "displays": to.displays, "watchers": to.watchers, "operators": to.operators })),
        ("links", json!((to.role == Role::Operator).then_some(links))),
        ("dir", json!(trusted.then(|| folder.display().to_string()))),
    ] {
        told[key] = value;
    }
    if !trusted {
        // Where things lie on this machine is nothing for others.
        let watched = state.set_up.watch.as_deref().unwrap_or_default();
        told["set_up"]["watch"] = Value::Null;
        leave_out(&mut told, &[&folder.display().to_string(), watched]);
    }
    if let (Role::Camera, Some(all)) = (to.role, told.as_object_mut()) {
        all.retain(|key, _| FOR_CAMERAS.contains(&key.as_str()));
    }
    told
}

fn steps(state: &State) -> Value {
    let step = |step: &Step| {
        let locked = state.locked(*step);
        let is = match (*step == state.step, locked.is_some(), *step < state.step) {
            (true, ..) => "current",
            (_, true, _) => "locked",
            (_, _, true) => "done",
            _ => "open",
        };
        json!({ "step": step, "state": is, "why": locked })
    };
    Step::ALL.iter().map(step).collect()
}

/// Takes folders out of all texts: what is in them keeps its name.
fn leave_out(value: &mut Value, folders: &[&str]) {
    match value {
        Value::String(text) => {
            for folder in folders.iter().filter(|f| f.len() > 1) {
                let within = format!(
                    "{}{}",
                    folder.trim_end_matches(std::path::MAIN_SEPARATOR),
                    std::path::MAIN_SEPARATOR
                );
                *text = text.replace(&within, "").replace(*folder, "the folder");
            }
        }
        Value::Array(all) => all.iter_mut().for_each(|v| leave_out(v, folders)),
        Value::Object(all) => all.values_mut().for_each(|v| leave_out(v, folders)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studio::machine::Options;
    use crate::studio::project::Settings;
    use crate::studio::state::Problem;
    use std::net::SocketAddr;

    fn told_to(role: Role) -> Value {
        let at: SocketAddr = "127.0.0.1:8642".parse().unwrap();
        let links = Links::new(&super::super::access::Access::new(at, &[]).unwrap(), "127.0.0.1:8642", None);
        let options = Options { watch: Some("/srv/camera/shots".into()), ..Options::default() };
        let (mut machine, _) = Machine::new(&Settings::default(), options);
        machine.state.problem = Some(Problem::new(
            "x",
            "/srv/rigs/work/rig.json: cannot be written",
            "/srv/camera/shots is full",
        ));
        let to = Listener { role, id: Some(3), operating: false, displays: 0, watchers: 0, operators: 0 };
        told(&machine, &to, &links, Path::new("/srv/rigs/work"))
    }

    #[test]
    fn paths_of_this_machine_are_for_its_own_pages() {
        assert!(told_to(Role::Operator).to_string().contains("/srv/rigs/work/rig.json"));
        for role in [Role::Watcher, Role::Camera] {
            let told = told_to(role).to_string();
            assert!(told.contains("rig.json: cannot be written") && !told.contains("/srv"), "{told}");
        }
    }

    #[test]
    fn a_phone_is_told_what_it_shows_and_no_addresses() {
        let told = told_to(Role::Camera);
        assert!(told["photographs"].is_array() && told["sentence"].is_string() && told["you"]["page"] == 3);
        for kept in ["links", "dir", "command", "set_up", "scan", "calibration"] {
            assert!(told.get(kept).is_none(), "{kept}");
        }
        assert!(told_to(Role::Watcher)["links"].is_null());
    }
}
