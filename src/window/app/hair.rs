//! The coat held against the hair that it stands for.

use super::{App, QUIET, Word};
use crate::data::image::Image8;
use crate::error::Result;
use crate::viewer::Combing;
use crate::window::canvas;
use crate::window::comparison::{self, Judged, Mode};
use crate::window::look::Look;
use crate::window::mailbox::Sender;
use crate::window::truth::{Order, Quality, Truth};
use egui::{
    Align2, Color32, ColorImage, Context, FontId, Rect, Response, Slider, TextureHandle, TextureOptions, Ui, pos2, vec2,
};
use std::sync::Arc;

/// The picture of the hair, and what came of laying the coat's over it.
pub(super) struct Hair {
    orders: Sender<Order>,
    ordered: Option<(Look, u64)>,
    truth: Option<Truth>,
    judged: Option<Judged>,
    /// Of the hair, and of the error map.
    textures: [Option<TextureHandle>; 2],
    /// Whether the line of a wipe is being pulled.
    pub(super) pulling: bool,
    /// What kept it from being drawn.
    why_not: Option<String>,
}

impl Hair {
    pub(super) fn new(orders: Sender<Order>) -> Self {
        Self { orders, ordered: None, truth: None, judged: None, textures: [None, None], pulling: false, why_not: None }
    }
}

/// Puts a picture where there was one before.
fn put(texture: &mut Option<TextureHandle>, context: &Context, name: &str, image: &Image8) {
    let image = ColorImage::from_rgba_unmultiplied([image.width as usize, image.height as usize], &image.pixels);
    match texture {
        Some(texture) => texture.set(image, TextureOptions::LINEAR),
        None => *texture = Some(context.load_texture(name, image, TextureOptions::LINEAR)),
    }
}

impl App {
    /// Whether the hair is wanted and drawn as well as it gets for this look, or not wanted.
    pub(super) fn compared(&self, look: &Look) -> bool {
        if self.state.comparison.mode == Mode::Off || self.hair.why_not.is_some() {
            return true;
        }
        let done = |truth: &Truth| truth.quality == Quality::Final && truth.look == *look;
        let (truth, judged) = (&self.hair.truth, &self.hair.judged);
        truth.as_ref().is_some_and(|truth| {
            done(truth) && judged.as_ref().is_some_and(|judged| Arc::ptr_eq(&judged.film, &truth.film))
        })
    }

    /// Orders the hair of what is seen once nothing moves.
    pub(super) fn order_hair(&mut self, size: [u32; 2]) {
        if self.state.comparison.mode == Mode::Off {
            return;
        }
        let Some(edits) = &self.edits else {
            self.hair.why_not =
                Some("a file with a coat does not hold its hair: open the mesh with a preset".to_owned());
            return;
        };
        if self.state.combing != Combing::default() {
            self.hair.why_not =
                Some("the hair is not combed anew with the coat: set length to 1 and slant to 0".to_owned());
            return;
        }
        self.hair.why_not = None;
        let still = self.changed.elapsed() >= QUIET && !self.state.clock.playing && !self.baking.due();
        let look = self.look(size);
        let wanted = (look.clone(), self.baking.change());
        if !still || self.hair.ordered.as_ref() == Some(&wanted) {
            return;
        }
        let name = |moment: crate::window::look::Moment| (moment.animation.to_string(), moment.seconds);
        self.hair.orders.put(Order {
            input: self.subject.input.clone(),
            reading: self.subject.reading,
            recipe: Box::new(edits.recipe().clone()),
            moment: look.moment.map(name),
            look,
        });
        self.hair.ordered = Some(wanted);
    }

    pub(super) fn grown(&mut self, truth: Result<Truth>) {
        match truth {
            Ok(truth) => {
                let image = truth.look.developed((*truth.film).clone());
                put(&mut self.hair.textures[0], &self.voice.context, "hair", &image);
                self.hair.truth = Some(truth);
                self.judge();
            }
            Err(error) => self.hair.why_not = Some(error.to_string()),
        }
    }

    /// Compares the two pictures that are there, on another thread, where they are of one look.
    pub(super) fn judge(&self) {
        let (Some(truth), Some(shown)) = (&self.hair.truth, &self.shown) else { return };
        if shown.coarseness != 1 || shown.look != truth.look || self.state.comparison.mode == Mode::Off {
            return;
        }
        let (film, coat, fringe_px) = (Arc::clone(&truth.film), Arc::clone(&shown.picture), truth.fringe_px);
        let voice = self.voice.clone();
        rayon::spawn(move || voice.say(Word::Judged(Box::new(Judged::new(film, coat.film(), fringe_px)))));
    }

    pub(super) fn judged(&mut self, judged: Result<Judged>) {
        match judged {
            Ok(judged) => {
                put(&mut self.hair.textures[1], &self.voice.context, "error map", &judged.image);
                self.hair.judged = Some(judged);
            }
            Err(error) => self.hair.why_not = Some(error.to_string()),
        }
    }

    /// How far off the coat is, where both pictures are there.
    pub fn comparison(&self) -> Option<&Judged> {
        self.hair.judged.as_ref()
    }

    /// Lays the hair or the error map over the coat's picture.
    pub(super) fn lay_beside(&self, ui: &Ui, response: &Response, left: Rect) {
        let comparison = &self.state.comparison;
        let fits = |truth: &Truth| self.shown.as_ref().is_some_and(|shown| shown.look == truth.look);
        let fits = self.hair.truth.as_ref().is_some_and(fits);
        let [hair, map] = &self.hair.textures;
        let rect = response.rect;
        if comparison.mode == Mode::Off {
            return;
        }
        let told = match (&self.hair.why_not, &self.hair.truth) {
            (Some(why), _) => why.clone(),
            (None, Some(truth)) if fits && truth.quality == Quality::Final => {
                format!("hair: final, {:.1} s", truth.ms / 1e3)
            }
            (None, Some(truth)) if fits => {
                format!("hair: a first look, {:.1} s; the final one is drawn", truth.ms / 1e3)
            }
            _ => "hair: drawn …".to_owned(),
        };
        match (comparison.mode, hair) {
            (Mode::Wipe, Some(hair)) if fits => {
                let line = rect.left() + comparison.wipe * rect.width();
                let part = Rect::from_min_max(rect.min, pos2(line, rect.bottom()));
                let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(comparison.wipe, 1.0));
                ui.painter().image(hair.id(), part, uv, Color32::WHITE);
                ui.painter().vline(line, rect.y_range(), (2.0, Color32::WHITE));
            }
            (Mode::Flip, Some(hair)) if fits && comparison.hair => canvas::paint(ui, rect, hair),
            (Mode::Side, Some(hair)) if fits => canvas::paint(ui, left, hair),
            (Mode::Side, _) => drop(ui.painter().rect_filled(left, 0.0, Color32::from_gray(60))),
            (Mode::Error, _) if fits => {
                if let Some(map) = map {
                    canvas::paint(ui, rect, map);
                }
                self.scale(ui, response);
            }
            _ => {}
        }
        label(ui, rect.left_top() + vec2(8.0, 8.0), Align2::LEFT_TOP, &told);
        if comparison.mode == Mode::Flip && fits {
            let which = if comparison.hair { "hair (H)" } else { "coat (H)" };
            label(ui, rect.right_top() + vec2(-8.0, 8.0), Align2::RIGHT_TOP, which);
        }
    }

    /// The error map's colours, and the value under the pointer.
    fn scale(&self, ui: &Ui, response: &Response) {
        let rect = response.rect;
        let bar = Rect::from_min_size(rect.left_bottom() + vec2(12.0, -40.0), vec2(220.0, 12.0));
        for i in 0..110 {
            let error = i as f32 / 109.0;
            let [r, g, b] = comparison::coded(error);
            let at = pos2(bar.left() + 2.0 * i as f32, bar.top());
            ui.painter().rect_filled(Rect::from_min_size(at, vec2(2.0, bar.height())), 0.0, Color32::from_rgb(r, g, b));
        }
        for (at, align, text) in [(bar.left(), Align2::LEFT_TOP, "FLIP 0"), (bar.right(), Align2::RIGHT_TOP, "1")] {
            label(ui, pos2(at, bar.bottom() + 3.0), align, text);
        }
        let Some(judged) = &self.hair.judged else { return };
        if let Some(at) = response.hover_pos() {
            let within = (at - rect.min) / rect.size();
            if let Some(error) = judged.at(within.x, within.y) {
                label(ui, at + vec2(14.0, 14.0), Align2::LEFT_TOP, &format!("FLIP {error:.4}"));
            }
        }
    }

    /// The panel's part about it.
    pub(super) fn hair_panel(&mut self, ui: &mut Ui) {
        egui::CollapsingHeader::new("Against the hair").default_open(false).show(ui, |ui| {
            let comparison = &mut self.state.comparison;
            ui.horizontal_wrapped(|ui| {
                for (name, mode) in Mode::ALL {
                    ui.selectable_value(&mut comparison.mode, mode, name);
                }
            });
            if comparison.mode == Mode::Wipe {
                ui.add(Slider::new(&mut comparison.wipe, 0.0..=1.0).text("line"));
            }
            if comparison.mode == Mode::Flip {
                ui.checkbox(&mut comparison.hair, "hair instead of coat");
            }
            let Some(judged) = self.hair.judged.as_ref().filter(|_| comparison.mode != Mode::Off) else { return };
            egui::Grid::new("likeness").num_columns(2).show(ui, |ui| {
                for (name, value) in judged.rows() {
                    ui.label(name);
                    ui.monospace(value);
                    ui.end_row();
                }
            });
        });
    }
}

/// A word on the picture, readable over anything.
fn label(ui: &Ui, at: egui::Pos2, align: Align2, text: &str) {
    let font = FontId::proportional(13.0);
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE);
    let rect = align.anchor_size(at, galley.size());
    ui.painter().rect_filled(rect.expand(3.0), 2.0, Color32::from_black_alpha(170));
    ui.painter().galley(rect.min, galley, Color32::WHITE);
}
