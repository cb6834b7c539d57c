//! The table's rows on both sides over all cases.

use crate::functions::case::Case;
use crate::functions::driver::Driver;
use crate::functions::shader::Shaders;
use crate::functions::table::Row;
use crate::functions::tables::Tables;
use crate::functions::trial::{CARD_FLIPS, Called, Trial, Verdict};
use rayon::prelude::*;
use std::collections::HashSet;

/// Cases of a function, a multiple of a workgroup; every eighth is made of corners.
pub(crate) const CASES: u32 = 76_800;

/// What functions are compared with.
struct Bench {
    driver: Driver,
    shaders: Shaders,
    tables: Tables,
}

/// What came of a row.
#[derive(Default)]
struct Tally {
    /// Different results in Rust.
    different: usize,
    excluded: u32,
    worst_ulps: u32,
    marginal: u32,
    complaints: Vec<String>,
}

/// Compares rows and prints a line for each; fails after the last.
pub(crate) fn check(scene: &str, rows: &[Row]) {
    let bench = Bench { driver: Driver::open(), shaders: Shaders::new(), tables: Tables::new(scene) };
    println!("{} (software: {}), {CASES} cases each", bench.driver.name, bench.driver.is_software);
    let permitted = if bench.driver.is_software { 0 } else { CASES as usize / CARD_FLIPS };
    let mut complaints = Vec::new();
    for row in rows {
        let tally = bench.compare(row);
        println!("{}", summary(row, &tally));
        if tally.complaints.len() > permitted {
            complaints.extend(tally.complaints.into_iter().take(3));
        }
    }
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

fn summary(row: &Row, tally: &Tally) -> String {
    let Tally { different, excluded, worst_ulps, marginal, complaints } = tally;
    format!(
        "{:20} {different:6} results, {excluded:5} excluded, worst {worst_ulps} ULP, {marginal} in the margin, {} wrong",
        row.name,
        complaints.len()
    )
}

impl Bench {
    fn compare(&self, row: &Row) -> Tally {
        let call = |number| Called::new(&Case::new(&self.tables, number), row);
        let called: Vec<Called> = (0..CASES).into_par_iter().map(call).collect();
        let found = self.on_device(row, &called);
        let results: HashSet<Vec<u32>> = called.iter().map(Called::result).collect();
        let mut tally = Tally { different: results.len(), ..Tally::default() };
        let size = found.len() / called.len();
        for (number, (called, found)) in (0..).zip(called.iter().zip(found.chunks(size))) {
            let is_software = self.driver.is_software;
            let trial = Trial { row, tables: &self.tables, is_software, number, called, found };
            match trial.verdict() {
                Verdict::Excluded => tally.excluded += 1,
                Verdict::Within(ulps) => tally.worst_ulps = tally.worst_ulps.max(ulps),
                Verdict::Marginal => tally.marginal += 1,
                Verdict::Wrong(complaint) => tally.complaints.push(complaint),
            }
        }
        tally
    }

    /// The device's results, as many words per case as a case can have.
    fn on_device(&self, row: &Row, called: &[Called]) -> Vec<u32> {
        let inputs = called[0].inputs.len();
        let outputs = called.iter().map(|case| case.outputs.len()).max().unwrap_or_default();
        let statements = row.statements.map_or_else(|| self.shaders.call(row.name), str::to_owned);
        let text = self.shaders.text(&statements, inputs, outputs);
        let mut words = Vec::new();
        for case in called {
            assert_eq!(case.inputs.len(), inputs, "{}: all cases take the same arguments", row.name);
            words.extend(case.inputs.iter().map(|word| word.bits()));
        }
        // A function without arguments still binds a buffer.
        words.push(0);
        self.driver.run(&text, &self.tables.contents(), &words, outputs * called.len())
    }
}
