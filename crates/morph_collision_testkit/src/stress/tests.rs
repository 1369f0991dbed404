use super::*;

#[test]
fn every_family_comes_through() {
    // Every door once, and trees of every leaf size several times.
    let reports = stress(DOORS, 7, || {});
    assert_eq!(reports.len(), Family::ALL.len());
    for report in reports {
        assert!(report.is_clean(), "{report:?}");
        assert_eq!(report.cases, DOORS);
        let bad_input = report.family == Family::BadInput;
        assert_eq!(report.errors_reported, if bad_input { DOORS } else { 0 });
        assert!(report.counts.pairs_truth > 0, "{} tries nothing", report.family);
        assert!(report.counts.containment_checks > 0);
    }
}

#[test]
fn cases_are_those_of_the_seed() {
    for family in Family::ALL {
        assert_eq!(Case::new(family, 3, 1), Case::new(family, 3, 1), "{family}");
        assert_ne!(Case::new(family, 3, 1), Case::new(family, 3, 2), "{family}");
        assert_ne!(Case::new(family, 3, 1), Case::new(family, 4, 1), "{family}");
    }
}

#[test]
fn both_sides_of_touching_are_among_the_last_places() {
    let mut touching = [0, 0];
    for index in 0..40 {
        let Case { meshes, situation } = Case::new(Family::LastPlace, index, 1);
        let touches = !situation.truth([&meshes[0], &meshes[1]]).is_empty();
        touching[usize::from(touches)] += 1;
    }
    assert!(touching.iter().all(|count| *count >= 8), "{touching:?}");
}

#[test]
fn a_panic_is_caught_with_what_it_says() {
    assert_eq!(panics::caught(|| 3), Ok(3));
    let caught = panics::caught(|| std::panic::panic_any("first".to_owned()));
    assert_eq!(caught, Err::<(), _>("first".to_owned()));
}

#[test]
fn what_is_accepted_or_not_named_is_told() {
    let told = |result: Result<(), &str>| door::refused(result, &["weight 3"]).err().unwrap_or_default();
    assert_eq!(told(Err("weight 3 is NaN")), "");
    assert!(told(Ok(())).contains("accepted"));
    assert!(told(Err("something is NaN")).contains("does not name"));
}
