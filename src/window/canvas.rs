//! The part of the window that shows the picture, and what the pointer does there.

use super::eye::Eye;
use egui::{PointerButton, Rect, Response, Sense, TextureHandle, Ui, pos2};

/// Degrees that a drag over the whole height turns.
const DEGREES: f64 = 180.0;

/// Takes all that is left of `ui` for the picture.
pub fn area(ui: &mut Ui) -> Response {
    ui.allocate_response(ui.available_size(), Sense::click_and_drag())
}

/// Pixels of a picture that fills `rect`.
pub fn size(ui: &Ui, rect: Rect) -> [u32; 2] {
    let scale = ui.ctx().pixels_per_point();
    [rect.width(), rect.height()].map(|edge| (edge * scale).round().clamp(1.0, 8192.0) as u32)
}

/// Lays the picture over `rect`.
pub fn paint(ui: &Ui, rect: Rect, texture: &TextureHandle) {
    let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), rect, all, egui::Color32::WHITE);
}

/// Moves the eye as the pointer is dragged or the wheel turned.
pub fn steer(ui: &Ui, response: &Response, eye: &mut Eye) {
    let height = f64::from(response.rect.height().max(1.0));
    let moved = response.drag_delta();
    let (x, y) = (f64::from(moved.x) / height, f64::from(moved.y) / height);
    let sideways = ui.input(|input| input.modifiers.shift);
    let dragged = |button| response.dragged_by(button);
    if dragged(PointerButton::Middle) || dragged(PointerButton::Primary) && sideways {
        eye.pan(-x, y);
    } else if dragged(PointerButton::Primary) {
        eye.orbit(-x * DEGREES, y * DEGREES);
    } else if dragged(PointerButton::Secondary) {
        eye.look(-x * eye.vfov_deg, y * eye.vfov_deg);
    }
    if response.hovered() {
        let (wheel, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = (-f64::from(wheel) / 400.0).exp() / f64::from(pinch).max(1e-3);
        if factor != 1.0 {
            eye.zoom(factor);
        }
    }
}
