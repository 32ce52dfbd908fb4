//! The panel of a preset's keys, each with its unit, its range and what it does.

use super::edits::Edits;
use super::sections;
use crate::preset::keys::{Key, Table, tables};
use egui::{CollapsingHeader, ComboBox, DragValue, IdSalt, Slider, TextEdit, Ui};
use serde_json::Value;
use std::sync::LazyLock;

/// Ranges that span more than this factor have a slider by powers.
const WIDE: f64 = 200.0;

static TABLES: LazyLock<Vec<Table>> = LazyLock::new(tables);

/// What the panel asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// A setting of a key.
    Set(String, String),
    /// The hand has left a control.
    LetGo,
    /// The last change taken back.
    Undo,
    /// It done again.
    Redo,
    /// The preset in this file.
    Save(String),
    /// The command line, for the clipboard.
    Copy,
}

/// What is typed into the panel's fields.
#[derive(Default)]
pub struct Typed {
    /// What keys are searched for.
    pub search: String,
    /// The file that the preset is saved as.
    pub file: String,
}

/// How wet the fur is, which is a key of the preset like others, at hand.
pub fn wetness(ui: &mut Ui, edits: &Edits) -> Vec<Wanted> {
    let mut amount = edits.recipe().preset.wet.amount;
    let response = ui.add(Slider::new(&mut amount, 0.0..=1.0).text("wetness").fixed_decimals(2));
    let set = response.changed().then(|| Wanted::Set("wet.amount".to_owned(), float(f64::from(amount))));
    let let_go = (response.drag_stopped() || response.lost_focus()).then_some(Wanted::LetGo);
    set.into_iter().chain(let_go).collect()
}

/// Draws the panel; what was wanted is returned.
pub fn show(ui: &mut Ui, edits: &Edits, typed: &mut Typed) -> Vec<Wanted> {
    let mut wanted = Vec::new();
    let [past, future] = edits.depth();
    ui.horizontal_wrapped(|ui| {
        if ui.add_enabled(past > 0, egui::Button::new("undo")).on_hover_text("Ctrl Z").clicked() {
            wanted.push(Wanted::Undo);
        }
        if ui.add_enabled(future > 0, egui::Button::new("redo")).on_hover_text("Ctrl Shift Z").clicked() {
            wanted.push(Wanted::Redo);
        }
        if ui.button("copy as command line").clicked() {
            wanted.push(Wanted::Copy);
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("save as");
        let field = TextEdit::singleline(&mut typed.file).hint_text("my-preset.toml").desired_width(150.0);
        ui.add(field).labelled_by(label.id);
        if ui.add_enabled(!typed.file.trim().is_empty(), egui::Button::new("save")).clicked() {
            wanted.push(Wanted::Save(typed.file.trim().to_owned()));
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("search");
        ui.add(TextEdit::singleline(&mut typed.search).desired_width(190.0)).labelled_by(label.id);
    });
    let preset = serde_json::to_value(&edits.recipe().preset).unwrap_or_default();
    let search = typed.search.trim().to_lowercase();
    let meant = |key: &Key| search.is_empty() || format!("{} {}", key.key, key.what).to_lowercase().contains(&search);
    for table in TABLES.iter() {
        let keys: Vec<&Key> = table.keys.iter().filter(|key| !key.key.contains('[') && meant(key)).collect();
        if keys.is_empty() {
            continue;
        }
        let title = if table.name.is_empty() { "preset" } else { &table.name };
        sections::obey(ui, &sections::named(&table.name), IdSalt::new(("table", title)));
        let header = CollapsingHeader::new(title).id_salt(("table", title));
        let header = if search.is_empty() { header } else { header.open(Some(true)) };
        header.show(ui, |ui| {
            for key in keys {
                one(ui, key, place(&preset, &key.key), &mut wanted);
            }
        });
    }
    wanted
}

/// The value that a key has now.
fn place<'a>(preset: &'a Value, key: &str) -> Option<&'a Value> {
    key.split('.').try_fold(preset, |value, part| value.get(part)).filter(|value| !value.is_null())
}

/// The control of one key.
fn one(ui: &mut Ui, key: &Key, now: Option<&Value>, wanted: &mut Vec<Wanted>) {
    let name = key.key.rsplit('.').next().unwrap_or(&key.key);
    let name = if ["mm", "relative"].contains(&name) { key.key.as_str() } else { name };
    let told = format!("{}: {}\n{}", key.key, key.expected(), key.what);
    let choices: Option<Vec<&str>> = key.value.strip_prefix("one of ").map(|all| all.split(", ").collect());
    if let (Some(choices), Some(chosen)) = (choices, now.and_then(Value::as_str)) {
        ComboBox::new(&key.key, name).selected_text(chosen).show_ui(ui, |ui| {
            for choice in choices {
                if ui.selectable_label(choice == chosen, choice).clicked() {
                    wanted.push(Wanted::Set(key.key.clone(), format!("{choice:?}")));
                }
            }
        });
        return;
    }
    match now {
        Some(Value::Bool(on)) => {
            let mut on = *on;
            if ui.checkbox(&mut on, name).on_hover_text(told).changed() {
                wanted.push(Wanted::Set(key.key.clone(), on.to_string()));
            }
        }
        Some(Value::Number(number)) => {
            let whole = !number.is_f64();
            let Some(mut value) = number.as_f64() else { return };
            let [low, high] = key.range.unwrap_or([0.0, 1e6]);
            let mut slider = Slider::new(&mut value, low..=high).text(name);
            if high > WIDE * low.max(1e-3) && low >= 0.0 {
                slider = slider.logarithmic(true).smallest_positive((high * 1e-6).max(1e-4));
            }
            if whole {
                slider = slider.integer();
            }
            if let Some(unit) = key.unit {
                slider = slider.suffix(format!(" {unit}"));
            }
            let response = ui.add(slider).on_hover_text(told);
            if response.changed() {
                let value = if key.value == "a power of two" { power_of_two(value) } else { value };
                let value = if whole { (value as i64).to_string() } else { float(value) };
                wanted.push(Wanted::Set(key.key.clone(), value));
            }
            if response.drag_stopped() || response.lost_focus() {
                wanted.push(Wanted::LetGo);
            }
        }
        Some(Value::Array(items)) if items.iter().all(is_numbers) => {
            let mut rows: Vec<Vec<f64>> = items.iter().map(numbers).collect();
            let flat = items.iter().all(Value::is_number);
            let range = key.range.unwrap_or([-1e6, 1e6]);
            let mut changed = false;
            ui.horizontal_wrapped(|ui| {
                for value in rows.iter_mut().flatten() {
                    changed |= field(ui, value, range, wanted);
                }
                ui.label(name).on_hover_text(&told);
            });
            if changed {
                let row = |row: &Vec<f64>| row.iter().map(|value| float(*value)).collect::<Vec<_>>().join(", ");
                let rows: Vec<String> = rows.iter().map(row).collect();
                let inner = if flat {
                    rows.join(", ")
                } else {
                    rows.iter().map(|row| format!("[{row}]")).collect::<Vec<_>>().join(", ")
                };
                wanted.push(Wanted::Set(key.key.clone(), format!("[{inner}]")));
            }
        }
        None | Some(Value::Null) if key.range.is_some() && key.value == "a number" => {
            let [low, high] = key.range.unwrap_or_default();
            ui.horizontal(|ui| {
                // Between the ends of a wide range, by powers.
                let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
                if ui.button("set").on_hover_text(&told).clicked() {
                    wanted.push(Wanted::Set(key.key.clone(), float(middle)));
                }
                ui.weak(name).on_hover_text(&told);
            });
        }
        None | Some(Value::String(_)) => {
            let mut text = now.and_then(Value::as_str).unwrap_or_default().to_owned();
            let id = ui.scope_id().with(&key.key);
            // What is being typed is set when the field is left.
            if let Some(typing) = ui.data(|data| data.get_temp::<String>(id)) {
                text = typing;
            }
            ui.horizontal(|ui| {
                let response = ui.add(TextEdit::singleline(&mut text).desired_width(140.0)).on_hover_text(&told);
                ui.label(name).on_hover_text(&told);
                if response.changed() {
                    ui.data_mut(|data| data.insert_temp(id, text.clone()));
                }
                if response.lost_focus() {
                    ui.data_mut(|data| data.remove::<String>(id));
                    if now.and_then(Value::as_str).unwrap_or_default() != text {
                        wanted.extend([Wanted::Set(key.key.clone(), format!("{text:?}")), Wanted::LetGo]);
                    }
                }
            });
        }
        Some(other) => {
            ui.weak(format!("{name}: {other} (changed in its file)")).on_hover_text(told);
        }
    }
}

/// A number, or a list of numbers.
fn is_numbers(value: &Value) -> bool {
    value.is_number() || value.as_array().is_some_and(|items| items.iter().all(Value::is_number))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map_or(std::slice::from_ref(value), Vec::as_slice).iter().filter_map(Value::as_f64).collect()
}

/// A number of a list. True where it was changed.
fn field(ui: &mut Ui, value: &mut f64, [low, high]: [f64; 2], wanted: &mut Vec<Wanted>) -> bool {
    let field = DragValue::new(value).range(low..=high).speed((high - low).min(10.0) * 0.005).max_decimals(4);
    let response = ui.add(field);
    if response.drag_stopped() || response.lost_focus() {
        wanted.push(Wanted::LetGo);
    }
    response.changed()
}

/// A number as TOML has it: with a point, in as few digits as tell it from the next.
fn float(value: f64) -> String {
    format!("{:?}", value as f32)
}

fn power_of_two(value: f64) -> f64 {
    libm::exp2(value.max(1.0).log2().round())
}
