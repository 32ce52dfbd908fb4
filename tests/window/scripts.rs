//! Scripts that drive the window.

use egui::{Key, Modifiers};
use furrier::window::script::{Action, Script};

#[test]
fn a_script_is_read_line_by_line() {
    let text = "# a demonstration\n\nresize 900 700\ndrop a map.hdr\npress Shift+F\nset orbit 35,12,1\nwait\nwait 1.5\npicture x.png\nquit\n";
    let read: Vec<Action> = Script::parse(text).unwrap().0.into();
    let expected = [
        Action::Resize([900, 700]),
        Action::Drop("a map.hdr".into()),
        Action::Press(Key::F, Modifiers::SHIFT),
        Action::Set("orbit".into(), "35,12,1".into()),
        Action::Wait(None),
        Action::Wait(Some(1.5)),
        Action::Picture("x.png".into()),
        Action::Quit,
    ];
    assert_eq!(read, expected);
}

#[test]
fn a_line_that_is_no_action_is_named() {
    for line in ["resize 900", "resize 10 10", "jump", "press Hyper+F", "wait long", "scale 9", "quit now", "drop"] {
        let error = Script::parse(&format!("wait\n{line}\n")).unwrap_err();
        assert_eq!((error.field.as_deref(), error.found.as_deref()), (Some("line 2"), Some(line)));
    }
}
