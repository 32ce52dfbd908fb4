//! The store by itself: what was put there comes out, or nothing does.

use furrier::cache::{Found, Key, Limits, Store};
use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

fn key(number: u64) -> Key {
    Key::new("test", &number).unwrap()
}

/// A value that compresses badly.
fn noise(number: u64, length: usize) -> Vec<u8> {
    let mut stream = furrier::math::hash::Stream::new(number);
    (0..length).map(|_| stream.bits() as u8).collect()
}

/// Makes a value look as if it was last used so long ago.
fn age(store: &Store, number: u64, hours: u64) {
    let file = fs::File::options().append(true).open(store.path(&key(number))).unwrap();
    file.set_modified(SystemTime::now() - Duration::from_secs(hours * 3600)).unwrap();
}

fn is_there(store: &Store, number: u64) -> bool {
    store.path(&key(number)).is_file()
}

#[test]
fn what_was_put_comes_out() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path().join("made/when/needed"));
    assert_eq!(store.get(&key(1)), Found::Absent);
    assert!(!store.folder().exists(), "looking makes no folder");
    for (number, value) in [(1, Vec::new()), (2, vec![7; 100_000]), (3, noise(3, 4096))] {
        store.put(&key(number), &value).unwrap();
        assert_eq!(store.get(&key(number)), Found::Value(value));
    }
    store.put(&key(1), b"another").unwrap();
    assert_eq!(store.get(&key(1)), Found::Value(b"another".into()));
    assert_eq!(store.get(&key(4)), Found::Absent);
}

#[test]
fn keys_differ_by_stage_and_by_all_that_a_value_is_made_from() {
    let made_from = [(1_u32, 2.0_f32, "a"), (2, 2.0, "a"), (1, -0.0, "a"), (1, 0.0, "a"), (1, 2.0, "b")];
    let mut keys: Vec<String> = made_from.iter().map(|of| Key::new("test", of).unwrap().name()).collect();
    keys.push(Key::new("other", &made_from[0]).unwrap().name());
    assert_eq!(Key::new("test", &made_from[0]).unwrap().name(), keys[0]);
    let count = keys.len();
    keys.sort();
    keys.dedup();
    assert_eq!(keys.len(), count);
}

#[test]
fn any_flipped_bit_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    store.put(&key(1), &noise(1, 40)).unwrap();
    let path = store.path(&key(1));
    let sound = fs::read(&path).unwrap();
    for bit in 0..sound.len() * 8 {
        let mut bytes = sound.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, bytes).unwrap();
        assert!(matches!(store.get(&key(1)), Found::Damaged(_)), "bit {bit}");
    }
    // A write that ended early, and a value in another's place.
    for length in [0, 1, 50, sound.len() - 1] {
        fs::write(&path, &sound[..length]).unwrap();
        assert!(matches!(store.get(&key(1)), Found::Damaged(_)), "{length} bytes");
    }
    store.put(&key(2), b"two").unwrap();
    fs::copy(store.path(&key(2)), &path).unwrap();
    assert!(matches!(store.get(&key(1)), Found::Damaged(_)));
    assert_eq!(store.get(&key(2)), Found::Value(b"two".into()));
    let verified = store.verify().unwrap();
    assert_eq!((verified.sound, verified.damaged.len()), (1, 1));
    assert_eq!(verified.damaged[0].0, path);
}

#[test]
fn many_may_write_and_read_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for round in 0..60 {
                    let number = round % 5;
                    let value = noise(number, 20_000);
                    match store.get(&key(number)) {
                        Found::Value(found) => assert_eq!(found, value),
                        Found::Absent => {}
                        Found::Damaged(fault) => panic!("{fault}"),
                    }
                    store.put(&key(number), &value).unwrap();
                }
            });
        }
    });
    let survey = store.survey().unwrap();
    assert_eq!((survey.values, survey.unfinished), (5, 0));
}

#[test]
fn a_folder_that_takes_nothing_is_an_error_and_reads_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    store.put(&key(1), b"one").unwrap();
    // Permissions do not stop the superuser; a file where a folder must be does.
    let other = Key::new("other", &2).unwrap();
    fs::write(folder.path().join("other"), "in the way").unwrap();
    assert!(store.put(&other, b"two").is_err());
    assert_eq!(store.get(&other), Found::Absent);
    assert_eq!(store.get(&key(1)), Found::Value(b"one".into()));
    assert_eq!(store.survey().unwrap().values, 1);
}

#[test]
fn the_oldest_go_first_until_the_rest_fits() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    for number in 1..=4 {
        store.put(&key(number), &noise(number, 1000)).unwrap();
        age(&store, number, 10 * number);
    }
    let one = store.survey().unwrap().bytes / 4;
    let removed = store.tidy(Limits { bytes: Some(2 * one + one / 2), age: None }).unwrap();
    assert_eq!((removed.files, removed.left_bytes), (2, 2 * one));
    assert_eq!([1, 2, 3, 4].map(|number| is_there(&store, number)), [true, true, false, false]);
    let removed = store.tidy(Limits { bytes: None, age: Some(Duration::from_secs(15 * 3600)) }).unwrap();
    assert_eq!((removed.files, removed.bytes), (1, one));
    assert_eq!([1, 2].map(|number| is_there(&store, number)), [true, false]);
    assert_eq!(store.tidy(Limits::default()).unwrap().files, 0);
}

#[test]
fn what_is_used_counts_as_new() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    for number in [1, 2] {
        store.put(&key(number), b"value").unwrap();
        age(&store, number, 48);
    }
    assert!(matches!(store.get(&key(2)), Found::Value(_)));
    store.tidy(Limits { bytes: None, age: Some(Duration::from_secs(24 * 3600)) }).unwrap();
    assert_eq!([1, 2].map(|number| is_there(&store, number)), [false, true]);
}

#[test]
fn tidying_touches_nothing_but_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    store.put(&key(1), b"value").unwrap();
    let own = store.path(&key(1));
    let beside = own.parent().unwrap();
    let old = |path: &Path| {
        fs::write(path, "text").unwrap();
        let file = fs::File::options().append(true).open(path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(7200)).unwrap();
    };
    let foreign = [folder.path().join("notes.txt"), beside.join("notes.txt"), folder.path().join("test/notes.txt")];
    foreign.iter().for_each(|path| old(path));
    // What a process that died left behind, and what one is writing now.
    old(&beside.join(".furrier-dead.part"));
    fs::write(beside.join(".furrier-alive.part"), "text").unwrap();
    assert_eq!(store.survey().unwrap().unfinished, 2);
    assert_eq!(store.tidy(Limits::default()).unwrap().files, 1);
    assert_eq!(store.clear().unwrap().files, 2);
    assert!(foreign.iter().all(|path| path.is_file()) && !own.exists());
    assert_eq!(Store::new(folder.path().join("nowhere")).clear().unwrap().files, 0);
}

/// Not a test of its own: run by another as a process on a disk that is full.
#[test]
fn child_that_keeps() {
    let Ok(folder) = std::env::var("FURRIER_TEST_KEEPS") else { return };
    let put = Store::new(folder).put(&key(1), &noise(9, 1 << 20));
    println!("put: {put:?}");
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_an_error_and_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::new(folder.path());
    store.put(&key(1), b"old").unwrap();
    // A limit on file size stands for the disk: writing fails in the middle.
    let mut command = std::process::Command::new("sh");
    let script = "trap '' XFSZ; ulimit -f 64; exec \"$0\" cache::store::child_that_keeps --exact --nocapture";
    command.arg("-c").arg(script).arg(std::env::current_exe().unwrap()).env("FURRIER_TEST_KEEPS", folder.path());
    let said = command.output().unwrap().stdout;
    let said = String::from_utf8_lossy(&said);
    assert!(said.contains("put: Err"), "{said}");
    assert_eq!(store.get(&key(1)), Found::Value(b"old".into()));
    assert_eq!(store.survey().unwrap().unfinished, 0, "nothing else is left behind");
}
