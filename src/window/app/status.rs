//! The line below the picture, and the list of keys.

use super::App;
use crate::window::keys;
use egui::{Align, Context, Layout, Ui};

impl App {
    pub(super) fn status(&mut self, ui: &mut Ui) {
        if let Some(error) = &self.trouble {
            let hint = error.hint.as_deref().unwrap_or("the window goes on: drop another file, or change what was set");
            let text = format!("{error}\n  {hint}");
            ui.colored_label(ui.visuals().error_fg_color, text);
            if ui.button("close this message").clicked() {
                self.trouble = None;
            }
            return;
        }
        ui.horizontal(|ui| {
            let state = match (self.step, self.at_rest()) {
                (Some(step), _) => format!("{step} …"),
                (None, true) => "final".to_owned(),
                (None, false) => "drawing …".to_owned(),
            };
            ui.label(state);
            ui.separator();
            ui.label(&self.subject.input);
            if let Some(note) = self.notes.last() {
                ui.separator();
                ui.label(note).on_hover_text(self.notes.join("\n"));
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.button("?").on_hover_text("keys").clicked() {
                    self.state.open.help = !self.state.open.help;
                }
            });
        });
    }

    pub(super) fn help(&mut self, context: &Context) {
        let room = context.content_rect().size() - egui::vec2(60.0, 100.0);
        let window = egui::Window::new("Keys").open(&mut self.state.open.help).resizable(false).vscroll(true);
        let window = window.default_size([room.x.min(620.0), room.y]).max_height(room.y);
        window.show(context, |ui| {
            // What does not fit beside its key goes on below.
            let widest = (0.65 * room.x).min(380.0);
            egui::Grid::new("keys").num_columns(2).max_col_width(widest).striped(true).show(ui, |ui| {
                for (key, what) in keys::LIST {
                    ui.strong(*key);
                    ui.add(egui::Label::new(*what).wrap());
                    ui.end_row();
                }
            });
        });
    }
}
