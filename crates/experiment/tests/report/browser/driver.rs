//! A browser without a window, driven through chromedriver (W3C WebDriver over HTTP).

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;
use ureq::Agent;
use ureq::http::Method;

/// Names under which systems install the browser.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
/// Nothing here takes long; a hanging browser must not hang the tests.
const TIMEOUT: Duration = Duration::from_mins(1);

/// A browser with one page.
pub(crate) struct Browser {
    driver: Child,
    agent: Agent,
    /// Address of the session.
    session: String,
    /// Goes with the browser.
    _profile: TempDir,
}

fn find(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file())
}

impl Browser {
    /// Starts a browser, or says that there is none.
    pub(crate) fn start() -> Option<Self> {
        let found = BROWSERS.iter().find_map(|name| find(name)).zip(find("chromedriver"));
        let Some((browser, driver)) = found else {
            let required = std::env::var_os("LIGHTCUTS_REQUIRE_BROWSER").is_some_and(|value| !value.is_empty());
            assert!(!required, "LIGHTCUTS_REQUIRE_BROWSER is set, but there is no Chromium with chromedriver");
            println!("skipped: there is no Chromium with chromedriver");
            return None;
        };
        let mut driver = Command::new(driver).arg("--port=0").stdout(Stdio::piped()).spawn().unwrap();
        let port = port(&mut driver);
        let agent: Agent =
            Agent::config_builder().http_status_as_error(false).timeout_global(Some(TIMEOUT)).build().into();
        let profile = tempfile::tempdir().unwrap();
        let options = json!({
            "binary": browser,
            "args": [
                "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                "--disable-background-networking", "--disable-component-update", "--disable-sync",
                "--disable-dev-shm-usage", "--hide-scrollbars",
                format!("--user-data-dir={}", profile.path().display()),
            ],
        });
        let mut started =
            Self { driver, agent, session: format!("http://127.0.0.1:{port}/session"), _profile: profile };
        let logs = json!({ "browser": "ALL", "performance": "ALL" });
        let wanted = json!({ "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": logs });
        let answer = started.send(&Method::POST, "", &json!({ "capabilities": { "alwaysMatch": wanted } }));
        started.session = format!("{}/{}", started.session, answer["sessionId"].as_str().unwrap());
        // The browser opens a start page, which is none of ours and may be unreachable.
        started.open("about:blank");
        for kind in ["browser", "performance"] {
            started.log(kind);
        }
        Some(started)
    }

    fn send(&self, method: &Method, command: &str, body: &Value) -> Value {
        let address = format!("{}{command}", self.session);
        let answer = match *method {
            Method::POST => self.agent.post(&address).send_json(body),
            Method::DELETE => self.agent.delete(&address).call(),
            _ => self.agent.get(&address).call(),
        };
        let mut answer = answer.unwrap_or_else(|error| panic!("{command}: {error}"));
        let text = answer.body_mut().with_config().limit(1 << 28).read_json::<Value>().unwrap();
        assert!(answer.status().is_success(), "{command}: {}", text["value"]["message"]);
        text["value"].clone()
    }

    fn post(&self, command: &str, body: &Value) -> Value {
        self.send(&Method::POST, command, body)
    }

    pub(crate) fn open(&self, url: &str) {
        self.post("/url", &json!({ "url": url }));
    }

    pub(crate) fn title(&self) -> String {
        self.send(&Method::GET, "/title", &Value::Null).as_str().unwrap().to_owned()
    }

    /// Names the page in logs.
    pub(crate) fn handle(&self) -> Value {
        self.send(&Method::GET, "/window", &Value::Null)
    }

    /// The value of a JavaScript expression.
    pub(crate) fn value(&self, expression: &str) -> Value {
        self.post("/execute/sync", &json!({ "script": format!("return {expression};"), "args": [] }))
    }

    /// Presses the pointer at the first place, drags it to the second and lets it go; in pixels of the window.
    pub(crate) fn drag(&self, from: (i64, i64), to: (i64, i64)) {
        let action =
            |kind: &str, (x, y): (i64, i64)| json!({ "type": kind, "x": x, "y": y, "duration": 20, "button": 0 });
        let half_way = (i64::midpoint(from.0, to.0), i64::midpoint(from.1, to.1));
        let actions = [
            action("pointerMove", from),
            action("pointerDown", from),
            action("pointerMove", half_way),
            action("pointerMove", to),
            action("pointerUp", to),
        ];
        self.actions(&json!({ "type": "pointer", "id": "mouse", "actions": actions }));
    }

    /// Presses keys one after the other.
    pub(crate) fn press(&self, keys: &[&str]) {
        let actions: Vec<Value> = keys
            .iter()
            .flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key })))
            .collect();
        self.actions(&json!({ "type": "key", "id": "keyboard", "actions": actions }));
    }

    fn actions(&self, source: &Value) {
        self.post("/actions", &json!({ "actions": [source] }));
    }

    /// A command of the DevTools protocol.
    pub(crate) fn devtools(&self, command: &str, parameters: &Value) -> Value {
        self.post("/goog/cdp/execute", &json!({ "cmd": command, "params": parameters }))
    }

    /// What was logged since the last call.
    pub(crate) fn log(&self, kind: &str) -> Vec<String> {
        let entries = self.post("/se/log", &json!({ "type": kind }));
        entries.as_array().unwrap().iter().map(|entry| entry["message"].as_str().unwrap().to_owned()).collect()
    }
}

/// The driver tells its port on standard output.
fn port(driver: &mut Child) -> u16 {
    let lines = BufReader::new(driver.stdout.take().unwrap()).lines();
    let told = lines.map_while(Result::ok).find_map(|line| {
        let port = line.split("on port ").nth(1)?;
        port.trim_end_matches('.').parse().ok().filter(|port| *port != 0)
    });
    told.expect("chromedriver tells its port")
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.agent.delete(&self.session).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
