//! Malformed experiment files: what is said, and where.

use crate::support::{Folder, HEAD, PAIR, complaint};

/// A head of six lines, one configuration on lines 7 to 9, then the case.
fn with(rest: &str) -> String {
    format!("{HEAD}[[configuration]]\nname = 'a'\nsettings = {{}}\n{rest}")
}

/// Line 1 of what follows `with`.
const LINE: usize = 10;

fn complaints(cases: &[(&str, usize, &str)]) {
    let folder = Folder::new();
    for (text, line, expected) in cases {
        let text = with(text);
        let found = complaint(&folder.try_plan(&text).err().unwrap_or_else(|| panic!("no fault in\n{text}")));
        let place = format!("a.toml:{}:", LINE + line);
        assert!(
            found.starts_with(&place) && found.contains(expected),
            "{place} {expected:?} expected of\n{text}\n{found}"
        );
    }
}

#[test]
fn typos_are_told_with_the_nearest_word() {
    complaints(&[
        ("[[points]]\nname = 'x'", 0, "unknown key `points`"),
        (
            "[[point]]\nnmae = 'x'",
            1,
            "unknown key `nmae`; expected `name`, `scenes`, `settings` (did you mean `name`?)",
        ),
        ("[[point]]\nname = 'x'\nsettings = { vpl = { propability = 1 } }", 2, "did you mean `probability`?"),
        ("[[point]]\nname = 'x'\nsettings = { gather = { strategy = 'lightcut' } }", 2, "did you mean `lightcuts`?"),
        (
            "[[point]]\nname = 'x'\nscenes = ['rooom']",
            2,
            "unknown scene `rooom`; expected `room` (did you mean `room`?)",
        ),
        ("[[section]]\nid = 'x'\ntitle = 'x'\nshows = 'time'", 3, "did you mean `times`?"),
        ("[[configuration]]\nname = 'b'\nreferences = ['A']", 2, "unknown configuration `A`; expected `a`, `b`"),
        ("[[configuration]]\nname = 'b'\ndevice = 'auto'", 2, "`auto` names no device; expected `cpu`, `gpu`"),
        ("[[configuration]]\nname = 'b'\nat = 'last'", 2, "unknown value `last`; expected `every-point`, `last-point`"),
        (
            "[[configuration]]\nname = 'b'\nat = 'last-point'\nreferences = ['a']",
            3,
            "a configuration at the last point is a reference for others and has none itself",
        ),
    ]);
}

#[test]
fn wrong_kinds_of_values_are_told_in_plain_words() {
    complaints(&[
        ("[[point]]\nname = 3", 1, "wrong kind of value: integer `3`, expected a string"),
        ("[[point]]\nname = 'x'\nscenes = 'room'", 2, "expected a list"),
        ("[[point]]\nname = 'x'\nsettings = 5", 2, "expected a table"),
        ("[[point]]\nname = 'x'\nsettings = { image = { width = 1.5 } }", 2, "expected a whole number, 0 or more"),
        ("[[point]]\nname = 'x'\nsettings = { gather = { threshold = 'x' } }", 2, "expected a number"),
        ("[[point]]\n", 0, "missing key `name`"),
        ("[[scene]]\nname = 'x'\n", 0, "missing key `file`"),
        ("[[scene]]\nname = 'x'\nfile = 'f'\nstand-in = { file = 'g' }", 3, "missing key `note`"),
        ("[[point]\nname = 'x'", 0, ""),
        ("[[section]]\nid = 'x'\ntitle = 'x'", 0, "missing key `shows`"),
        ("[[section]]\nid = 'x'\ntitle = 'x'\nshows = 'images'\nscene = 'room'", 0, "missing key `configurations`"),
        ("[[section]]\nid = 'x'\ntitle = 'x'\nshows = 5", 3, "expected a string"),
        ("[[section]]\nid = 'x'\ntitle = 'x'\nshows = 'images'\nscene = 7", 4, "expected a string"),
    ]);
}

#[test]
fn parameters_out_of_range_are_told_where_they_are_set_last() {
    let point = "[[point]]\nname = 'x'\nsettings = { image = { width = 0 } }";
    complaints(&[
        (point, 2, "image.width is 0; expected 1 to 65536"),
        ("[[point]]\nname = 'x'\n[point.settings.gather]\nthreshold = nan", 3, "gather.threshold is NaN"),
        ("[[point]]\nname = 'x'\nsettings = { run = { seed = 2 } }", 2, "run.seed is 2; expected `seeds = [2]`"),
        ("[[configuration]]\nname = 'b'\nsettings = { run = { reproduce = true } }", 2, "expected 512 x 512 pixels"),
    ]);
    let folder = Folder::new();
    let text = with("").replace("height = 16", "height = 0");
    let found = complaint(&folder.try_plan(&text).unwrap_err());
    assert!(found.starts_with("a.toml:3:32: image.height is 0"), "{found}");
}

#[test]
fn names_are_words_and_stand_once() {
    complaints(&[
        ("[[configuration]]\nname = 'a b'", 1, "`a b` cannot be a name"),
        ("[[configuration]]\nname = '../a'", 1, "cannot be a name"),
        ("[[configuration]]\nname = 'a--b'", 1, "cannot be a name"),
        ("[[configuration]]\nname = ''", 1, "cannot be a name"),
        ("[[configuration]]\nname = 'A'", 1, "two tables [[configuration]] have the name `A`"),
        ("[[scene]]\nname = 'room'\nfile = 'scene.txt'", 1, "two tables [[scene]] have the name `room`"),
        ("[[point]]\nname = 'x'\n[[point]]\nname = 'x'\nscenes = ['room']", 3, "two points of the scene `room`"),
        ("[[point]]\nname = 'x'\nscenes = []", 2, "the list is empty"),
        ("[[point]]\nname = 'x'\nscenes = ['room', 'room']", 2, "`room` stands twice"),
        (
            "[[section]]\nid = 'x'\ntitle = 'x'\nshows = 'text'\n[[section]]\nid = 'x'\ntitle = 'y'\nshows = 'text'",
            5,
            "two sections have the id `x`",
        ),
    ]);
}

#[test]
fn references_are_rendered_and_not_chained() {
    complaints(&[
        ("[[configuration]]\nname = 'b'\nreferences = ['b']", 2, "its own reference"),
        (
            "[[configuration]]\nname = 'b'\nreferences = ['a']\n[[configuration]]\nname = 'c'\nreferences = ['b']",
            5,
            "the reference `b` has references itself",
        ),
        ("[[configuration]]\nname = 'b'\nreferences = ['a', 'a']", 2, "`a` stands twice"),
        (
            "[[scene]]\nname = 'hall'\nfile = 'scene.txt'\n[[configuration]]\nname = 'b'\nscenes = ['room']\n\
             [[configuration]]\nname = 'c'\nreferences = ['b']",
            8,
            "`b` is not rendered in the scene `hall`",
        ),
        (
            "[[configuration]]\nname = 'b'\nreferences = ['a']\nsettings = { image = { width = 8 } }",
            2,
            "the picture has 8 x 16 pixels, that of the reference `a` 24 x 16",
        ),
    ]);
}

#[test]
fn sections_name_what_is_there() {
    let section = |keys: &str| format!("[[section]]\nid = 'x'\ntitle = 'x'\n{keys}");
    let cases = [
        ("shows = 'text'\nscene = 'room'", 4, "unknown key `scene`; expected `id`"),
        ("shows = 'times'\nscene = 'hall'\nconfigurations = ['a']", 4, "unknown scene `hall`"),
        ("shows = 'times'\nscene = 'room'\nconfigurations = ['a', 'b']", 5, "unknown configuration `b`"),
        ("shows = 'times'\nscene = 'room'\nconfigurations = []", 5, "there are no configurations"),
        ("shows = 'times'\nscene = 'room'\nconfigurations = ['a']\npublished = '5.1'", 6, "no published figures"),
        ("shows = 'times'\nscene = 'room'\nconfigurations = ['a']\nruns = 5", 6, "unknown key `runs`"),
        ("shows = 'images'\nscene = 'room'\nconfigurations = ['a']\npoint = 'p'", 6, "unknown point `p`"),
        ("shows = 'agreement'\nconfigurations = ['a']\nmetrics = ['mse', 'rsme']", 5, "did you mean `rmse`?"),
        ("shows = 'agreement'\nconfigurations = ['a']\nmetrics = []\npublished-pass = ['x']", 6, "unknown scene `x`"),
        (
            "shows = 'acceleration'\nchart = 'c'\nrows = [{ title = 't', slow = 'a', fast = 'z', time = 'total' }]",
            5,
            "unknown configuration `z`",
        ),
        (
            "shows = 'acceleration'\nchart = 'c'\nrows = [{ title = 't', slow = 'a', fast = 'a', time = 'all' }]",
            5,
            "unknown value `all`; expected `first-pass`, `second-pass`, `total`",
        ),
        ("shows = 'curves'\nscene = 'room'\nconfigurations = ['a']\nquantity = 'speed'", 6, "unknown value `speed`"),
        (
            "shows = 'curves'\nscene = 'room'\nconfigurations = ['a']\nquantity = { metric = 'x' }",
            6,
            "unknown metric `x`",
        ),
        (
            "shows = 'curves'\nscene = 'room'\nconfigurations = ['a']\nquantity = 'light-ratio'\ncrossover = ['a', 'q']",
            7,
            "unknown configuration `q`",
        ),
        ("shows = 'published-arithmetic'", 3, "no published figures"),
    ];
    let cases: Vec<_> = cases.iter().map(|(keys, line, expected)| (section(keys), *line, *expected)).collect();
    complaints(&cases.iter().map(|(text, line, expected)| (text.as_str(), *line, *expected)).collect::<Vec<_>>());
}

#[test]
fn the_head_is_checked() {
    let folder = Folder::new();
    let cases = [
        ("runs = 0", "runs is 0; expected 1 to 1000"),
        ("threads = 5000", "threads is 5000; expected 0 to 1024"),
        ("seeds = []", "the list is empty"),
        ("seeds = [1, 2, 1]", "`1` stands twice"),
        ("seeds = [-1]", "expected a whole number, 0 or more"),
        ("metrics = ['mse', 'flop']", "unknown metric `flop`"),
        ("metrics = ['flip']", "unknown metric `flip`"),
        ("published = { source = 'x', times = 'none.csv' }", "none.csv"),
        ("published = { times = 'none.csv' }", "missing key `source`"),
    ];
    for (line, expected) in cases {
        let text = format!("{line}\n{HEAD}{PAIR}");
        let found = complaint(&folder.try_plan(&text).unwrap_err());
        assert!(found.starts_with("a.toml:1:") && found.contains(expected), "{line}: {found}");
    }
    let lacking =
        [("name = 'x'\n", "there is no [[scene]]"), ("", "missing key `name`"), (HEAD, "no [[configuration]]")];
    for (text, expected) in lacking {
        let found = complaint(&folder.try_plan(text).unwrap_err());
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn scenes_are_there_and_sound() {
    let folder = Folder::new();
    let missing = complaint(&folder.try_plan(&format!("{}{PAIR}", HEAD.replace("scene.txt", "none.txt"))).unwrap_err());
    assert!(missing.starts_with("a.toml:6:8: ") && missing.contains("none.txt"), "{missing}");
    folder.write("scene.txt", "C nonsense\n");
    let wrong = folder.try_plan(&format!("{HEAD}{PAIR}")).unwrap_err().to_string();
    assert!(wrong.contains("scene.txt:1:"), "{wrong}");
}

#[test]
fn the_physical_model_is_refused_wherever_it_is_asked_for() {
    complaints(&[
        (
            "[[point]]\nname = 'x'\nsettings = { run = { model = 'physical' } }",
            2,
            "run.model is physical, but experiments render the thesis' model only",
        ),
        (
            "[[configuration]]\nname = 'b'\n[configuration.settings.physical]\nvpls = 100",
            3,
            "`physical.vpls` has no meaning here: experiments render the thesis' model only",
        ),
        (
            "[[configuration]]\nname = 'b'\nsettings = { gather = { strategy = 'stochastic' } }",
            2,
            "in the thesis' model",
        ),
    ]);
    let folder = Folder::new();
    folder.write(
        "b.toml",
        "format = 'lightcuts-scene'\nversion = 1\n[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\n",
    );
    let found = complaint(&folder.try_plan(&with("").replace("scene.txt", "b.toml")).unwrap_err());
    assert!(found.starts_with("a.toml:6:8: experiments render the thesis' model only"), "{found}");
    let found = complaint(&folder.try_plan(&with("").replace("scene.txt", "none.toml")).unwrap_err());
    assert!(found.starts_with("a.toml:6:8: cannot read "), "{found}");
}
