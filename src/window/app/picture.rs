//! The picture: ordered, hung, laid beside that of the hair.

use super::{App, QUIET};
use crate::window::canvas;
use crate::window::comparison::Mode;
use crate::window::drawing::{Answer, Order, Sway};
use crate::window::look::Look;
use crate::window::model::Model;
use egui::{ColorImage, Rect, TextureOptions, Ui};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time that a picture may take while something moves, ms.
const MOVING_MS: f64 = 90.0;
/// How long pictures stay coarse for a bake.
const PATIENCE: Duration = Duration::from_millis(2500);
/// Coarsest picture while something moves.
const COARSEST: u32 = 8;

/// What was ordered last.
pub(super) struct Ordered {
    model: Arc<Model>,
    look: Look,
    coarseness: u32,
    count: bool,
}

impl App {
    pub(super) fn picture(&mut self, ui: &mut Ui) {
        let response = canvas::area(ui);
        // Side by side each has half of the room.
        let mut rects = [response.rect, response.rect];
        if self.state.comparison.mode == Mode::Side {
            let middle = response.rect.center().x;
            (rects[0].max.x, rects[1].min.x) = (middle, middle);
        }
        let size = canvas::size(ui, rects[1]);
        self.aspect = f64::from(size[0]) / f64::from(size[1]);
        self.frame_again();
        if !self.wipe(ui, &response) {
            canvas::steer(ui, &response, &mut self.state.eye);
        }
        self.order(ui, size);
        self.order_hair(size);
        match &self.texture {
            Some(texture) => canvas::paint(ui, rects[1], texture),
            None => drop(ui.put(response.rect, egui::Spinner::new())),
        }
        self.lay_beside(ui, &response, rects[0]);
    }

    /// Moves the line of a wipe, where the pointer drags it.
    fn wipe(&mut self, ui: &Ui, response: &egui::Response) -> bool {
        let comparison = &mut self.state.comparison;
        if comparison.mode != Mode::Wipe {
            return false;
        }
        let rect: Rect = response.rect;
        let line = rect.left() + comparison.wipe * rect.width();
        let near = |x: f32| (x - line).abs() < 12.0;
        let began = ui.input(|input| input.pointer.press_origin()).is_some_and(|at| near(at.x));
        if response.hover_pos().is_some_and(|at| near(at.x)) {
            ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
        }
        if !(response.dragged() && (began || self.hair.pulling)) {
            self.hair.pulling = false;
            return false;
        }
        self.hair.pulling = true;
        if let Some(at) = response.interact_pointer_pos() {
            comparison.wipe = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        true
    }

    /// Orders a picture where there is a newer one to draw: a coarse one while something moves, then the whole.
    fn order(&mut self, ui: &Ui, size: [u32; 2]) {
        let Some(model) = self.model.clone() else { return };
        let look = self.look(size);
        let last = self.ordered.as_ref();
        let moved = !last.is_some_and(|last| Arc::ptr_eq(&last.model, &model) && last.look == look);
        if moved {
            self.changed = Instant::now();
        }
        let sways = self.state.spring.is_some();
        // A coat that is still baked needs the processor more than its draft does, for a while.
        let baking = self.baking.due() && self.changed.elapsed() < PATIENCE;
        let rest = self.changed.elapsed() >= QUIET && !self.state.clock.playing && !sways && !baking;
        let coarseness = if rest { 1 } else { self.coarseness() };
        let count = self.state.open.counting && rest;
        let newer = rest && last.is_none_or(|last| (last.coarseness, last.count) != (coarseness, count));
        if !rest {
            ui.ctx().request_repaint_after(QUIET);
        }
        if moved || newer || sways {
            let sway = self.state.spring.map(|spring| Sway { spring, wind: self.state.wind, at: Instant::now() });
            self.draw.put(Order { model: Arc::clone(&model), look: look.clone(), coarseness, count, sway });
            self.ordered = Some(Ordered { model, look, coarseness, count });
        }
    }

    /// How coarse a picture must be to be drawn in time, by what the last one took.
    fn coarseness(&self) -> u32 {
        let Some(shown) = &self.shown else { return COARSEST / 2 };
        let whole_ms = shown.statistics.wall_ms * f64::from(shown.coarseness).powi(2);
        ((whole_ms / MOVING_MS).sqrt().ceil() as u32).clamp(1, COARSEST)
    }

    pub(super) fn hang(&mut self, answer: Answer) {
        let size = [answer.image.width as usize, answer.image.height as usize];
        let image = ColorImage::from_rgba_unmultiplied(size, &answer.image.pixels);
        match &mut self.texture {
            Some(texture) => texture.set(image, TextureOptions::LINEAR),
            None => self.texture = Some(self.voice.context.load_texture("picture", image, TextureOptions::LINEAR)),
        }
        self.baking.seen(&answer.model);
        self.shown = Some(answer);
        self.judge();
    }
}
