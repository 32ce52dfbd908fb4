//! The panel's sections, opened and closed by name, as scripts do.

use crate::error::{Error, Result};
use crate::preset::keys::tables;
use egui::collapsing_header::CollapsingState;
use egui::{Context, Id, IdSalt, Ui, UiBuilder};

/// Titles of the panel's sections, from the top.
pub const TITLES: [&str; 9] =
    ["View", "Light", "Animation", "Comb", "Motion", "Statistics", "Against the hair", "Preset", "Window"];

/// What was asked for and is not drawn yet: a name, and whether it is to be open.
type Asked = Vec<(String, bool)>;

fn asked() -> Id {
    Id::unique("sections that a script asked for")
}

/// Opens or closes the section of this name the next time that it is drawn: a title as [`called`], or `preset.TABLE`.
///
/// # Errors
/// [`crate::error::Kind::Usage`] where there is none, with those that there are.
pub fn ask(context: &Context, name: &str, open: bool) -> Result<()> {
    let titles = TITLES.iter().map(|title| called(title));
    let tables = tables().into_iter().map(|table| named(&table.name));
    let names: Vec<String> = titles.chain(tables).collect();
    if !names.iter().any(|known| known == name) {
        return Err(Error::usage("the panel has no such section")
            .with_field("section")
            .with_found(name)
            .with_expected(names.join(", ")));
    }
    let within = (open && name.starts_with("preset.")).then(|| "preset".to_owned());
    let all = within.into_iter().chain([name.to_owned()]).map(|name| (name, open));
    context.data_mut(|data| data.get_temp_mut_or_default::<Asked>(asked()).extend(all));
    Ok(())
}

/// What scripts call a section: one word.
pub fn called(title: &str) -> String {
    title.to_lowercase().replace(' ', "-")
}

/// What a table of the preset is called among sections.
pub fn named(table: &str) -> String {
    if table.is_empty() { "preset.preset".to_owned() } else { format!("preset.{table}") }
}

/// Does what was asked of the section `name`, whose header `ui` shows next under this salt.
pub fn obey(ui: &mut Ui, name: &str, salt: IdSalt) {
    let all = ui.data_mut(|data| {
        let all = data.get_temp_mut_or_default::<Asked>(asked());
        let (mine, others) = std::mem::take(all).into_iter().partition::<Asked, _>(|(section, _)| section == name);
        *all = others;
        mine
    });
    for (_, open) in all {
        // A header lies in a part of its own.
        let id = ui.new_child(UiBuilder::new()).make_persistent_id(salt);
        let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, !open);
        state.set_open(open);
        state.store(ui.ctx());
    }
}
