//! Faults in shaders and in what their formulas are compared by.

#[test]
fn formulas_tell_a_thousandth_and_what_is_not_a_number() {
    use crate::formulas::Worst;
    let faults = |got: f32| {
        let mut worst = Worst::default();
        worst.note(0, "sound", 0.5, 0.5);
        worst.note(1, "faulty", got, 0.5);
        worst.faults(2e-4).len()
    };
    assert_eq!((faults(0.5), faults(0.5005), faults(f32::NAN)), (0, 1, 1));
}

/// The shaders' modules, one constant of `module` a twentieth larger.
fn drifted(shared: &[furrier::gpu::Source], module: &str, name: &str) -> Vec<furrier::gpu::Source> {
    use furrier::gpu::{Constant, Source, Text};
    let mut found = false;
    let mut drift = |constant: &Constant| match *constant {
        Constant::F32(own, value) if own == name => {
            found = true;
            Constant::F32(own, 1.05 * value)
        }
        other => other,
    };
    let of = |source: &Source| match source.text {
        Text::Constants(constants) if source.path == module => {
            Source::constants(source.path, constants.iter().map(&mut drift).collect::<Vec<_>>().leak())
        }
        _ => *source,
    };
    let all = shared.iter().map(of).collect();
    assert!(found, "no constant {name} in {module}");
    all
}

#[test]
fn formulas_tell_a_constant_of_a_shader_that_drifts() {
    use crate::formulas::{coat, hair};
    use furrier::{hybrid::gpu::kernels, runtime::gpu::pipelines};
    for name in ["PI", "HORIZON", "DEEPEST_HAIR", "LARGEST"] {
        assert!(!hair::formulas(&drifted(&kernels::SHARED, "constants", name)).is_empty(), "{name} may drift");
    }
    for name in ["PI", "LEAST_VOLUME", "LEAST_BULK", "LEAST_COSINE", "LEAST_CLEAR", "FADE_BELOW"] {
        assert!(!coat::law(&drifted(&pipelines::SHARED, "constants", name)).is_empty(), "{name} may drift");
    }
}

#[test]
fn formulas_tell_a_constant_of_the_law_that_drifts() {
    use furrier::gpu::Constant;
    use furrier::volume::lighting::LAW_CONSTANTS;
    for constant in LAW_CONSTANTS {
        let Constant::F32(name, _) = constant else { panic!("{constant:?} is not one number") };
        let shared = drifted(&furrier::hybrid::gpu::kernels::SHARED, "law_constants", name);
        assert!(!crate::formulas::law::formulas(&shared).is_empty(), "{name} may drift");
    }
}

#[test]
fn a_function_that_nothing_compares_is_named() {
    use crate::formulas::list::{declared, faults};
    let files = [("shared/a.wgsl".to_owned(), declared("fn used(x: f32) -> f32 {\n}\nfn other() {\n}\n"))];
    let compared = std::collections::BTreeSet::from(["used".to_owned()]);
    assert_eq!(faults(&files, &compared, &[("shared/a.wgsl", &["other"], "a reason")]), Vec::<String>::new());
    assert_eq!(faults(&files, &compared, &[]), ["shaders/shared/a.wgsl: nothing compares `other`"]);
    let stale = faults(&files, &compared, &[("shared/a.wgsl", &["other", "used", "gone"], "a reason")]);
    assert_eq!(stale.len(), 2, "{stale:?}");
}

#[test]
fn pixels_of_skin_and_fins_tell_a_hundredth_of_light() {
    use crate::formulas::look::like;
    use furrier::math::DVec3;
    let light = DVec3::new(0.6, 0.4, 0.2);
    assert!(like([0.6, 0.4, 0.2, 0.9], light, 0.9));
    for (faulty, alpha) in [(light * 1.01, 0.9), (light, 0.91), (light * f64::NAN, 0.9)] {
        assert!(!like([0.6, 0.4, 0.2, 0.9], faulty, alpha));
    }
}

#[test]
fn twins_tell_faults_between_mips_and_at_guards() {
    use crate::twins::{PLANTED, alike, planted};
    for fault in PLANTED {
        let found = planted(fault);
        println!("{fault:?}: {found:?}");
        assert!(!alike(found), "{fault:?} passes: {found:?}");
    }
}
