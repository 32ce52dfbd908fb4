//! The window's contents on egui's harness, drawn by the software adapter.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use furrier::bake::recipe::Choices;
use furrier::gpu::Choice;
use furrier::runtime::{Blending, Show};
use furrier::stage::options::Options;
use furrier::viewer::{Combing, Shown};
use furrier::window::{App, Begin, Wish, keys, loading, script::Script, sections};
use std::time::{Duration, Instant};

/// A ball with short, quickly baked hair.
pub fn ball() -> loading::Subject {
    let settings = ["shells.texture_size=16", "shells.layers=4"].map(String::from).to_vec();
    let choices = Choices { settings, ..Choices::default() };
    loading::Subject { input: "sample:sphere".into(), reading: Default::default(), choices: Some(choices), cache: None }
}

pub fn begin(subject: loading::Subject) -> Begin {
    Begin {
        subject,
        stage: Options::default(),
        shown: Shown::Coat(Show::default()),
        level: None,
        combing: Combing::default(),
        blend: Blending::Sorted,
        moment: None,
        shadow: true,
        device: Choice::Auto,
        in_words: |input, choices| format!("{input} {}", choices.settings.join(" ")),
        script: Script::default(),
    }
}

/// The contents of a window, and what was wished of it.
pub struct Contents {
    pub harness: Harness<'static, (Option<App>, Option<Begin>, Vec<Wish>)>,
}

impl Contents {
    pub fn new(begin: Begin) -> Self {
        let show = |ui: &mut egui::Ui, (app, begin, wishes): &mut (Option<App>, Option<Begin>, Vec<Wish>)| {
            if let Some(begin) = begin.take() {
                *app = Some(App::new(begin, ui.ctx()).unwrap());
            }
            wishes.extend(app.as_mut().unwrap().frame(ui));
        };
        let builder = Harness::builder().with_size([900.0, 700.0]).with_accessibility_check(false).wgpu();
        let mut contents = Self { harness: builder.build_ui_state(show, (None, Some(begin), Vec::new())) };
        contents.settle();
        contents
    }

    pub fn app(&mut self) -> &mut App {
        self.harness.state_mut().0.as_mut().unwrap()
    }

    /// Until nothing is baked or drawn any more.
    pub fn settle(&mut self) {
        let start = Instant::now();
        self.harness.step();
        self.harness.step();
        while !self.app().at_rest() {
            assert!(start.elapsed() < Duration::from_secs(240), "it does not come to rest");
            std::thread::sleep(Duration::from_millis(20));
            self.harness.step();
        }
        self.harness.step();
    }
}

#[test]
fn a_mesh_is_baked_shown_and_said_to_be_final() {
    let mut contents = Contents::new(begin(ball()));
    contents.harness.get_by_label("final");
    let picture = contents.harness.render().unwrap();
    let [middle, corner] = [(300, 340), (20, 20)].map(|(x, y)| picture.get_pixel(x, y).0);
    assert!(corner[0].abs_diff(corner[2]) < 25, "a grey wall: {corner:?}");
    assert!(i32::from(middle[0]) > i32::from(middle[2]) + 15, "a fox is red: {middle:?}");
}

#[test]
fn keys_turn_frame_show_and_list() {
    let mut contents = Contents::new(begin(ball()));
    let first = contents.app().state.eye;
    contents.harness.key_press(egui::Key::ArrowRight);
    contents.harness.step();
    assert_eq!(contents.app().state.eye.azimuth_deg, first.azimuth_deg + 15.0);
    contents.app().state.eye.zoom(3.0);
    contents.harness.key_press(egui::Key::F);
    contents.harness.step();
    let framed = contents.app().state.eye;
    assert!((framed.distance_m / first.distance_m - 1.0).abs() < 0.2, "{framed:?} {first:?}");
    contents.harness.key_press(egui::Key::V);
    contents.harness.step();
    assert_eq!(contents.app().state.shown, Shown::Coat(Show { skin: false, shells: true, fins: false }));
    assert!(contents.harness.query_by_label("frame the asset").is_none());
    contents.harness.key_press(egui::Key::F1);
    contents.harness.step();
    contents.harness.step();
    contents.harness.get_by_label("frame the asset");
}

#[test]
fn a_panel_s_control_is_reached_by_its_label() {
    let mut contents = Contents::new(begin(ball()));
    assert!(contents.app().state.lighting.shadow);
    contents.harness.get_by_label("shadow of the first light").click();
    contents.harness.step();
    contents.harness.step();
    assert!(!contents.app().state.lighting.shadow);
    contents.settle();
    contents.harness.get_by_label("final");
}

#[test]
fn another_blending_is_another_picture() {
    let weighted = Begin { blend: Blending::Weighted, ..begin(ball()) };
    let mut contents = Contents::new(weighted);
    assert_eq!(contents.app().state.blend, Blending::Weighted);
    let first = contents.harness.render().unwrap();
    contents.app().state.blend = Blending::Sorted;
    contents.settle();
    // Of the picture alone: the panel names the blending too.
    let second = contents.harness.render().unwrap();
    let changed = |x: u32, y: u32| first.get_pixel(x, y) != second.get_pixel(x, y);
    let all = (0..550).flat_map(|x| (0..650).map(move |y| (x, y))).filter(|&(x, y)| changed(x, y)).count();
    assert!(all > 1000, "{all}");
}

#[test]
fn sections_are_opened_and_closed_by_name() {
    let mut contents = Contents::new(begin(ball()));
    let steps = |contents: &mut Contents| (0..30).for_each(|_| contents.harness.step());
    assert!(contents.harness.query_all_by_label("exposure").next().is_some());
    assert!(contents.harness.query_all_by_label("search").next().is_none());
    let context = contents.harness.ctx.clone();
    sections::ask(&context, "light", false).unwrap();
    sections::ask(&context, "preset.guard", true).unwrap();
    steps(&mut contents);
    assert!(contents.harness.query_all_by_label("exposure").next().is_none());
    for label in ["search", "guard.length.mm"] {
        assert!(contents.harness.query_all_by_label(label).next().is_some(), "{label}");
    }
    let unknown = sections::ask(&context, "warmth", true).unwrap_err();
    assert!(unknown.expected.unwrap().contains("against-the-hair"));
}

#[test]
fn the_list_of_keys_fits_a_small_window() {
    let mut contents = Contents::new(begin(ball()));
    contents.harness.set_size([600.0, 400.0].into());
    contents.app().state.open.help = true;
    (0..10).for_each(|_| contents.harness.step());
    for (key, what) in keys::LIST {
        for text in [key, what] {
            let place = contents.harness.get_by_label(text).rect();
            assert!(place.left() >= 0.0 && place.right() <= 600.0, "{text}: {place:?}");
        }
    }
}
