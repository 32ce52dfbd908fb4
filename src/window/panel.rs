//! The panel with all controls.

use super::drawing::Statistics;
use super::lighting::Source;
use super::model::Model;
use super::state::State;
use crate::math::Vec3;
use crate::runtime::{Blending, Spring};
use crate::stage::background::Background;
use crate::stage::rig::Rig;
use crate::stage::tone::Tone;
use crate::viewer::{CHANNELS, Combing, LENGTHS, OUT_OF_LINE, SLANTS_DEG};
use egui::{CollapsingHeader, ComboBox, Grid, Label, RichText, Slider, Ui};

/// The window itself: colours and size of its writing.
pub fn window(ui: &mut Ui) {
    CollapsingHeader::new("Window").default_open(false).show(ui, |ui| {
        egui::widgets::global_theme_preference_buttons(ui);
        ui.weak("Ctrl + and Ctrl − change the size of writing.");
    });
}

/// Draws the panel's sections.
pub fn show(ui: &mut Ui, state: &mut State, model: Option<&Model>, statistics: Option<&Statistics>) {
    let section = |title: &str, open| CollapsingHeader::new(title.to_owned()).default_open(open);
    section("View", true).show(ui, |ui| view(ui, state, model));
    section("Light", true).show(ui, |ui| light(ui, state));
    if let Some(model) = model.filter(|model| !model.animations.is_empty()) {
        section("Animation", true).show(ui, |ui| animation(ui, state, model));
    }
    section("Comb", false).show(ui, |ui| comb(ui, state, statistics));
    section("Motion", false).show(ui, |ui| motion(ui, state));
    section("Statistics", false).show(ui, |ui| numbers(ui, state, model, statistics));
}

fn view(ui: &mut Ui, state: &mut State, model: Option<&Model>) {
    ComboBox::from_label("channel").selected_text(state.shown.to_string()).show_ui(ui, |ui| {
        for (name, shown) in CHANNELS {
            ui.selectable_value(&mut state.shown, shown, name);
        }
    });
    let levels = model.map_or(0, State::levels);
    let name = |level: Option<usize>| level.map_or("by size".to_owned(), |level| level.to_string());
    ComboBox::from_label("level of detail").selected_text(name(state.level)).show_ui(ui, |ui| {
        for level in std::iter::once(None).chain((0..levels).map(Some)) {
            ui.selectable_value(&mut state.level, level, name(level));
        }
    });
    let blended = Blending::ALL.iter().find(|(_, way)| *way == state.blend).map_or("", |(name, _)| name);
    ComboBox::from_label("blending").selected_text(blended).show_ui(ui, |ui| {
        for (name, way) in Blending::ALL {
            ui.selectable_value(&mut state.blend, way, name);
        }
    });
    let cameras = model.map_or(&[][..], |model| &model.subject.cameras);
    for named in cameras {
        let label = format!("camera {}", named.names.first().map_or("", String::as_str));
        match &named.value {
            Ok(camera) => {
                if ui.button(label).clicked() {
                    state.eye = super::eye::Eye::of(camera);
                }
            }
            Err(error) => drop(ui.add_enabled(false, egui::Button::new(label)).on_disabled_hover_text(&error.what)),
        }
    }
    ui.add(Slider::new(&mut state.eye.vfov_deg, 5.0..=100.0).text("field of view").suffix("°").fixed_decimals(0));
}

fn light(ui: &mut Ui, state: &mut State) {
    let lighting = &mut state.lighting;
    let name = |source: Source| match source {
        Source::Asked if lighting.asked.lights.is_empty() => "studio".to_owned(),
        Source::Asked => "of the command line".to_owned(),
        Source::Rig(rig) => rig.to_string(),
        Source::Surroundings => lighting.surroundings.as_ref().map_or("map".to_owned(), |map| map.name.clone()),
    };
    let rigs = Rig::ALL.into_iter().filter(|rig| *rig != Rig::Studio || !lighting.asked.lights.is_empty());
    let map = lighting.surroundings.is_some().then_some(Source::Surroundings);
    let all: Vec<(Source, String)> = std::iter::once(Source::Asked)
        .chain(rigs.map(Source::Rig))
        .chain(map)
        .map(|source| (source, name(source)))
        .collect();
    ComboBox::from_label("light").selected_text(name(lighting.source)).show_ui(ui, |ui| {
        for (source, name) in all {
            ui.selectable_value(&mut lighting.source, source, name);
        }
    });
    ui.add(Slider::new(&mut lighting.turn_deg, -180.0..=180.0).text("turn").suffix("°").fixed_decimals(0));
    if lighting.source == Source::Surroundings {
        ui.checkbox(&mut lighting.sky, "sky behind the asset");
    } else {
        ui.add(Slider::new(&mut lighting.raise_deg, -90.0..=90.0).text("raise").suffix("°").fixed_decimals(0));
    }
    if lighting.surroundings.is_none() {
        ui.weak("An .hdr or .exr file dropped here becomes light and sky.");
    }
    ui.add(Slider::new(&mut lighting.stops, -8.0..=8.0).text("light").suffix(" stops").fixed_decimals(2));
    ui.checkbox(&mut lighting.shadow, "shadow of the first light");
    let development = &mut state.development;
    ui.add(Slider::new(&mut development.exposure_ev, -8.0..=8.0).text("exposure").suffix(" EV").fixed_decimals(2));
    let mut rolled = development.tone == Tone::Neutral;
    if ui.checkbox(&mut rolled, "roll off what is too bright").changed() {
        development.tone = if rolled { Tone::Neutral } else { Tone::None };
    }
    ui.horizontal(|ui| {
        ui.selectable_value(&mut development.background, Background::Backdrop, "wall");
        let mut colour = match development.background {
            Background::Colour(colour) => colour.to_array(),
            _ => [0.18; 3],
        };
        let picked = ui.color_edit_button_rgb(&mut colour).changed();
        let plain = matches!(development.background, Background::Colour(_));
        if ui.selectable_label(plain, "one colour").clicked() || picked {
            development.background = Background::Colour(Vec3::from(colour));
        }
        ui.label("behind");
    });
}

fn animation(ui: &mut Ui, state: &mut State, model: &Model) {
    let clock = &mut state.clock;
    let name = |at: Option<usize>| at.map_or("rest pose", |at| model.animations[at].name.as_str());
    let chosen = clock.animation;
    ComboBox::from_label("animation").selected_text(name(chosen)).show_ui(ui, |ui| {
        for at in std::iter::once(None).chain((0..model.animations.len()).map(Some)) {
            ui.selectable_value(&mut clock.animation, at, name(at));
        }
    });
    if clock.animation != chosen {
        clock.seconds = 0.0;
    }
    let Some(at) = clock.animation else { return };
    ui.horizontal(|ui| {
        if ui.button(if clock.playing { "stop" } else { "play" }).clicked() {
            clock.playing = !clock.playing;
        }
        ui.add(Slider::new(&mut clock.speed, 0.0..=4.0).text("speed").fixed_decimals(2));
    });
    let longest = model.animations[at].seconds;
    let scrub = Slider::new(&mut clock.seconds, 0.0..=longest).text("time").suffix(" s").fixed_decimals(2);
    if ui.add(scrub).changed() {
        clock.playing = false;
    }
}

/// Length and slant of the coat as it is: the preset's own are baked anew.
fn comb(ui: &mut Ui, state: &mut State, statistics: Option<&Statistics>) {
    let combing = &mut state.combing;
    ui.add(
        Slider::new(&mut combing.length, LENGTHS[0]..=LENGTHS[1]).text("length").logarithmic(true).fixed_decimals(2),
    );
    ui.add(
        Slider::new(&mut combing.slant_deg, SLANTS_DEG[0]..=SLANTS_DEG[1]).text("slant").suffix("°").fixed_decimals(0),
    );
    if *combing != Combing::default() && ui.button("as baked").clicked() {
        *combing = Combing::default();
    }
    let Some(step) = statistics.map(|statistics| statistics.step_texels) else { return };
    let lines_up = if step > OUT_OF_LINE { "layers no longer line up" } else { "layers line up" };
    ui.weak(format!("{lines_up}: {step:.1} texels along the skin from one to the next"));
}

fn motion(ui: &mut Ui, state: &mut State) {
    let mut sways = state.spring.is_some();
    if ui.checkbox(&mut sways, "hair swings").changed() {
        state.spring = sways.then(Spring::default);
    }
    let Some(spring) = &mut state.spring else { return };
    ui.add(Slider::new(&mut spring.frequency_hz, 0.3..=12.0).text("swings").suffix(" Hz").logarithmic(true));
    ui.add(Slider::new(&mut spring.damping, 0.02..=0.99).text("damping"));
    let wind = &mut state.wind;
    ui.add(Slider::new(&mut wind.speed_m_per_s, 0.0..=15.0).text("wind").suffix(" m/s").fixed_decimals(1));
    ui.add(Slider::new(&mut wind.gusts, 0.0..=1.0).text("gusts").fixed_decimals(2));
    let mut towards_deg = wind.towards.x.atan2(wind.towards.z).to_degrees();
    let turn = Slider::new(&mut towards_deg, -180.0..=180.0).text("blows to").suffix("°").fixed_decimals(0);
    if ui.add(turn).changed() {
        let radians = towards_deg.to_radians();
        wind.towards = Vec3::new(libm::sinf(radians), 0.0, libm::cosf(radians));
    }
}

fn numbers(ui: &mut Ui, state: &mut State, model: Option<&Model>, statistics: Option<&Statistics>) {
    ui.checkbox(&mut state.open.counting, "count reads (a further pass)");
    let Some(statistics) = statistics else { return };
    // A long name of an adapter goes on below instead of widening the panel.
    Grid::new("statistics").num_columns(2).max_col_width(170.0).show(ui, |ui| {
        for (name, value) in rows(state, model, statistics) {
            ui.label(name);
            ui.add(Label::new(RichText::new(value).monospace()).wrap());
            ui.end_row();
        }
    });
    for line in &statistics.legend {
        ui.weak(line);
    }
}

/// What there is to count of a picture, by name.
pub fn rows(state: &State, model: Option<&Model>, statistics: &Statistics) -> Vec<(&'static str, String)> {
    let mega = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
    let triangles: u64 = statistics.passes.iter().map(|pass| pass.triangles).sum();
    let draws: u64 = statistics.passes.iter().map(|pass| pass.draw_calls).sum();
    let [textures, geometry, targets] = statistics.memory;
    let why = match state.level {
        Some(_) => "as asked",
        None => "by the hair's height",
    };
    let mut rows = vec![
        ("picture", format!("{:.0} ms", statistics.wall_ms)),
        ("triangles", triangles.to_string()),
        ("draws", draws.to_string()),
        ("level", format!("{:.2}, {why}", statistics.level)),
        ("hair's height", format!("{:.1} pixels", statistics.height_px)),
    ];
    for pass in &statistics.passes {
        rows.push((pass.name, pass.ms.map_or("the adapter has no clock".to_owned(), |ms| format!("{ms:.1} ms"))));
    }
    rows.push(("reads per covered pixel", statistics.reads.map_or("not counted".to_owned(), |n| format!("{n:.1}"))));
    if let Some(tile) = model.and_then(|model| model.coat.tiles.first()) {
        rows.push(("layers", tile.shells.layers.to_string()));
    }
    if let Some(model) = model.filter(|model| model.furred()) {
        let all = &model.coat.primitives;
        rows.push(("fins", all.iter().map(|primitive| primitive.fins.len()).sum::<usize>().to_string()));
        rows.push(("passages between presets", all.iter().filter(|p| p.blend.is_some()).count().to_string()));
    }
    rows.push(("textures", mega(textures)));
    rows.push(("geometry", mega(geometry)));
    rows.push(("targets", mega(targets)));
    if statistics.no_shadow {
        rows.push(("shadow", "none: the light stands too near".to_owned()));
    }
    rows.push(("drawn by", statistics.device.clone()));
    rows
}
