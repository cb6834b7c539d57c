//! GPUs in reports: which of their times is told, how they are named, and what is said of a driver that is none.

use crate::fixture::{Results, assert_near, number, times};

#[test]
fn the_time_of_a_gpu_is_the_elapsed_one() {
    let report = Results::new()
        .with_gpu("gpu", "Card 9000")
        .with_thesis_figures()
        .with("t", times("simple", Some("5.1")))
        .with("a", crate::acceleration::section(Some("5.5")))
        .report();
    let gpu = report.row("t", &[("configuration", "gpu")]);
    // Elapsed times of the fixture are half of processor times.
    assert_eq!((gpu["device"].as_str(), gpu["absent"].as_str()), ("gpu", ""));
    assert_near(number(&gpu, "second_pass_cpu_s"), 2.0);
    assert_near(number(&gpu, "second_pass_elapsed_s"), 1.0);
    assert_near(number(&gpu, "second_pass_ratio"), 45.457);
    assert_eq!(report.row("t", &[("configuration", "cpu")])["device"], "cpu");
    let markdown = report.text("report.md");
    assert!(markdown.contains("processor seconds over all threads, of GPUs elapsed seconds, mean"), "{markdown}");
    assert!(markdown.contains("1. Rendered on Card 9000 (GPU): elapsed seconds.\n"), "{markdown}");
    assert!(!markdown.contains("slower than the CPU renderer"), "{markdown}");
    // 1 s elapsed against 4 s, negative because lightcuts is slower on this GPU.
    assert_near(number(&report.row("a", &[("row", "gpu pass 2"), ("scene", "simple")]), "percent"), -75.0);
    assert!(report.page().contains("\u{2212}75.0"));
}

#[test]
fn cpu_and_gpu_are_no_mixture_but_two_gpus_of_one_configuration_are() {
    let mut results = Results::new().with_gpu("gpu", "Card 9000").with("t", times("simple", None));
    let page = results.report().page().to_owned();
    assert!(page.contains("Card 9000 (GPU); Test Processor (CPU, 1 thread)"));
    assert!(!page.contains("do not come from one place"));
    results.rows.iter_mut().rev().take(1).for_each(|row| row.device.name = "Card 10".to_owned());
    assert!(results.report().page().contains("2 devices: Card 10 (GPU); Card 9000 (GPU)."));
}

#[test]
fn a_software_driver_is_called_one() {
    let mut results = Results::new()
        .with_gpu("software gpu", "llvmpipe")
        .with("t", times("galleon", None))
        .with("a", crate::acceleration::section(None));
    results.scene("galleon").stand_in = Some("our ship".to_owned());
    let report = results.report();
    let markdown = report.text("report.md");
    for expected in [
        "llvmpipe rendered as a GPU. That is not a graphics card",
        "its times tell nothing of GPUs",
        "Test Processor (CPU, 1 thread); llvmpipe (software GPU)",
        "Rendered on llvmpipe (software GPU): elapsed seconds. That is not a graphics card but a driver that runs on the \
         processor, and is slower than the CPU renderer itself.",
        "| GPU <sup>1, 2</sup> |",
    ] {
        assert!(markdown.contains(expected), "{expected} is missing in:\n{markdown}");
    }
}

#[test]
fn renders_with_faults_are_named() {
    let mut results = Results::new().with_gpu("gpu", "Card 9000");
    assert!(!results.report().page().contains("did not return all its results"));
    results.rows.last_mut().unwrap().stats.device_faults = 2;
    let report = results.report();
    let markdown = report.text("report.md");
    assert!(markdown.contains("galleon, gpu-lightcuts, run 3: Card 9000 (GPU)."), "{markdown}");
}
