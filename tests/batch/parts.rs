//! Parts that need no bake: ranges, the order of work, plans.

use super::{furrier, json, succeeds, triangles};
use furrier::batch::estimate::Cost;
use furrier::batch::plan::Plan;
use furrier::batch::range;
use furrier::batch::schedule::{Begun, Schedule};

#[test]
fn ranges_are_read_as_schedulers_write_them() {
    assert_eq!(range::parse("3", 10).unwrap(), [3]);
    assert_eq!(range::parse("0-3,7, 2", 10).unwrap(), [0, 1, 2, 3, 7]);
    assert_eq!(range::parse("1-9:3", 10).unwrap(), [1, 4, 7]);
    for text in ["", "-", "3-1", "0-10", "a", "1-2:0", "0,,1"] {
        assert!(range::parse(text, 10).is_err(), "{text}");
    }
}

/// Works off costs of seconds and bytes; gives what was begun in order. What runs is ended one by one, the quickest first.
fn worked(costs: &[(f64, u64)], threads: usize, memory: Option<u64>) -> Vec<Begun> {
    let items = costs.iter().enumerate().map(|(i, &(seconds, bytes))| (i, Cost { seconds, bytes })).collect();
    let mut schedule = Schedule::new(items, threads, memory);
    let (mut begun, mut running): (Vec<Begun>, Vec<Begun>) = (Vec::new(), Vec::new());
    loop {
        while let Some(next) = schedule.begin() {
            begun.push(next);
            running.push(next);
        }
        let bytes: u64 = running.iter().map(|b| b.cost.bytes).sum();
        assert!(running.iter().map(|b| b.threads).sum::<usize>() <= threads, "too many threads");
        assert!(
            memory.is_none_or(|memory| bytes <= memory || running.len() == 1 && running[0].over),
            "too much memory"
        );
        running.sort_by(|a, b| b.cost.seconds.total_cmp(&a.cost.seconds));
        let Some(ended) = running.pop() else { return begun };
        schedule.end(&ended, memory);
    }
}

#[test]
fn the_longest_are_begun_first_within_threads_and_memory() {
    let order = |begun: &[Begun]| begun.iter().map(|b| b.item).collect::<Vec<_>>();
    let costs = [(1.0, 10), (4.0, 10), (2.0, 10), (3.0, 10)];
    let begun = worked(&costs, 2, None);
    assert_eq!(order(&begun), [1, 3, 2, 0]);
    assert!(begun.iter().all(|b| b.threads == 1));
    // Few assets share all threads; the last ones get what is left.
    assert_eq!(worked(&costs[..3], 16, None).iter().map(|b| b.threads).collect::<Vec<_>>(), [5, 5, 6]);
    assert_eq!(worked(&costs[..1], 16, None)[0].threads, 16);
    // Where memory is for one alone, that one has all threads, and smaller ones fill what is left beside larger ones.
    assert!(worked(&costs, 4, Some(10)).iter().all(|b| b.threads == 4 && !b.over));
    let begun = worked(&[(9.0, 80), (8.0, 50), (1.0, 20)], 3, Some(100));
    assert_eq!(order(&begun), [0, 2, 1]);
    // What fits nowhere runs alone, and says so.
    let begun = worked(&[(9.0, 200), (1.0, 50), (2.0, 50)], 2, Some(100));
    assert_eq!(begun.iter().filter(|b| b.over).map(|b| b.item).collect::<Vec<_>>(), [0]);
    assert_eq!(begun.len(), 3);
}

#[test]
fn a_plan_is_read_as_it_was_written_and_faults_are_named() {
    let folder = triangles(3);
    let path = folder.path().join("plan.jsonl");
    let mut command = furrier(&["batch", "plan"]);
    command.arg(folder.path()).args(["--preset", "mink", "--set", "guard.taper=0.3", "--write"]).arg(&path);
    let (code, value) = json(&mut command);
    assert_eq!((code, value["items"].as_u64()), (0, Some(3)), "{value}");
    let plan = Plan::read(&path).unwrap();
    assert_eq!((plan.entries.len(), plan.recipes[0].preset.guard.taper), (3, 0.3));
    assert!(plan.entries.iter().all(|entry| entry.cost.is_some_and(|cost| cost.seconds > 0.5 && cost.bytes > 1 << 24)));
    let again = folder.path().join("again.jsonl");
    plan.write(&again).unwrap();
    assert_eq!(std::fs::read(&again).unwrap(), std::fs::read(&path).unwrap());
    let text = std::fs::read_to_string(&path).unwrap();
    for (broken, place) in [
        (text.replace("\"item\":1", "\"item\":5"), "line 3"),
        (text.replace("\"recipe\":0", "\"recipe\":3"), "line 2"),
        (text.lines().take(3).collect::<Vec<_>>().join("\n"), "line 1"),
        (text.replace("furrier_plan\":1", "furrier_plan\":9"), "line 1"),
        ("{}".into(), "line 1"),
    ] {
        std::fs::write(&again, broken).unwrap();
        assert_eq!(Plan::read(&again).unwrap_err().field.as_deref(), Some(place));
    }
    let mut command = furrier(&["batch", "run"]);
    let refused = command.arg(&path).args(["--items", "0-3"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    succeeds(furrier(&["batch", "emit", "slurm"]).arg(&path).arg("-o").arg(folder.path().join("job.sh")));
}
