//! Chromium without a window, controlled through a pipe (its DevTools protocol).

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

/// Names of the browser; the variable CHROMIUM names another.
const NAMES: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
];

/// Everything is drawn by the processor, so that pictures are the same on any machine.
const OPTIONS: [&str; 7] = [
    "--headless=new",
    "--no-sandbox",
    "--remote-debugging-pipe",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--force-color-profile=srgb",
];

/// No answer within this time is a failure.
const PATIENCE: Duration = Duration::from_secs(90);

/// Where the browser is, if there is one.
pub fn find() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("CHROMIUM") {
        return Some(path.into());
    }
    let folders = std::env::var_os("PATH")?;
    let places = std::env::split_paths(&folders)
        .flat_map(|folder| NAMES.iter().map(move |name| folder.join(name)));
    places.into_iter().find(|path| path.is_file())
}

/// A page in a separate browser.
pub struct Page {
    child: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    session: String,
    asked: u64,
    /// Messages of the console and the log other than plain notes.
    pub complaints: Vec<Value>,
    _profile: TempDir,
}

/// How a page is shown.
#[derive(Clone, Copy)]
pub struct Screen {
    pub width: u32,
    pub height: u32,
    pub dark: bool,
}

impl Page {
    /// Opens a file, and waits until its view is drawn or says why it is not.
    pub fn open(browser: &Path, file: &Path, screen: Screen) -> (Self, Duration) {
        let mut page = Self::blank(browser);
        let Screen {
            width,
            height,
            dark,
        } = screen;
        page.call("Page.enable", json!({}));
        page.call("Runtime.enable", json!({}));
        page.call("Log.enable", json!({}));
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600});
        page.call("Emulation.setDeviceMetricsOverride", metrics);
        let scheme = if dark { "dark" } else { "light" };
        let media = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        page.call("Emulation.setEmulatedMedia", media);
        let began = Instant::now();
        page.call(
            "Page.navigate",
            json!({"url": format!("file://{}", file.display())}),
        );
        page.wait_for(
            "document.readyState === 'complete' && (!!document.getElementById('view').dataset.ready \
             || !document.getElementById('excuse').hidden)",
        );
        (page, began.elapsed())
    }

    fn blank(browser: &Path) -> Self {
        let profile = tempfile::tempdir().unwrap();
        // The browser reads from descriptor 3 and writes to 4.
        let mut child = Command::new("sh")
            .arg("-c")
            .arg("exec \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>/dev/null")
            .arg("sh")
            .arg(browser)
            .args(OPTIONS)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let to = child.stdin.take().unwrap();
        let answers = BufReader::new(child.stdout.take().unwrap());
        let (send, from) = channel();
        std::thread::spawn(move || {
            for message in answers.split(0).map_while(Result::ok) {
                let parsed = serde_json::from_slice(&message).unwrap();
                if send.send(parsed).is_err() {
                    break;
                }
            }
        });
        let mut page = Self {
            child,
            to,
            from,
            session: String::new(),
            asked: 0,
            complaints: Vec::new(),
            _profile: profile,
        };
        let made = page.call("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": made["targetId"], "flatten": true});
        let attached = page.call("Target.attachToTarget", target);
        page.session = attached["sessionId"].as_str().unwrap().to_owned();
        page
    }

    /// A command of the protocol and its result.
    pub fn call(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let mut message = json!({"id": self.asked, "method": method, "params": params});
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.to
            .write_all(format!("{message}\0").as_bytes())
            .unwrap();
        loop {
            let answer = self
                .from
                .recv_timeout(PATIENCE)
                .unwrap_or_else(|_| panic!("no answer to {method}"));
            if answer["id"] == self.asked {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.note(answer);
        }
    }

    fn note(&mut self, event: Value) {
        let kind = event["params"]["type"].as_str().unwrap_or_default();
        let bad = match event["method"].as_str().unwrap_or_default() {
            "Runtime.exceptionThrown" | "Log.entryAdded" => true,
            "Runtime.consoleAPICalled" => matches!(kind, "error" | "warning" | "assert"),
            _ => false,
        };
        if bad {
            self.complaints.push(event["params"].clone());
        }
    }

    /// The value of an expression in the page.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let asked = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", asked);
        assert!(
            answer["exceptionDetails"].is_null(),
            "{expression}: {answer}"
        );
        answer["result"]["value"].clone()
    }

    pub fn wait_for(&mut self, condition: &str) {
        let began = Instant::now();
        while self.evaluate(condition) != true {
            assert!(began.elapsed() < PATIENCE, "in vain: {condition}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits until the view has been drawn in full and nothing more is to come.
    pub fn rest(&mut self) {
        self.wait_for("femdem.view.atRest");
        self.evaluate(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))",
        );
    }

    pub fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        let buttons = u8::from(kind != "mouseReleased");
        let event = json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1});
        self.call("Input.dispatchMouseEvent", event);
    }

    /// The canvas at rest: what it shows once two looks agree, as a busy machine may lag behind.
    pub fn settled(&mut self) -> Picture {
        self.rest();
        let mut before = self.canvas();
        for _ in 0..40 {
            std::thread::sleep(Duration::from_millis(400));
            let now = self.canvas();
            if now.pixels == before.pixels {
                return now;
            }
            before = now;
        }
        before
    }

    /// Whether the canvas shows what is wanted within the waiting time.
    pub fn comes_to(&mut self, wanted: impl Fn(&Picture) -> bool) -> bool {
        self.rest();
        (0..40).any(|look| {
            if look > 0 {
                std::thread::sleep(Duration::from_millis(400));
            }
            wanted(&self.canvas())
        })
    }

    /// What the canvas shows: width, and red, green and blue of each pixel, row by row.
    pub fn canvas(&mut self) -> Picture {
        let found = self.evaluate(
            "(() => { const b = document.getElementById('view').getBoundingClientRect(); \
             return { x: b.x + scrollX, y: b.y + scrollY, width: b.width, height: b.height, scale: 1 }; })()",
        );
        // Beyond the viewport the page would temporarily be laid out and drawn again.
        let asked = json!({"format": "png", "clip": found});
        let answer = self.call("Page.captureScreenshot", asked);
        Picture::of(answer["data"].as_str().unwrap())
    }

    /// Keeps a picture of the whole page for people, if the variable FEMDEM_SCREENSHOTS names a folder.
    pub fn keep(&mut self, name: &str) {
        if let Some(folder) = std::env::var_os("FEMDEM_SCREENSHOTS") {
            let asked = json!({"format": "png", "captureBeyondViewport": true});
            let answer = self.call("Page.captureScreenshot", asked);
            let bytes = unbase64(answer["data"].as_str().unwrap());
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes).unwrap();
        }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Pixels of a screenshot.
pub struct Picture {
    pub width: usize,
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    fn of(base64: &str) -> Self {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(unbase64(base64)));
        decoder.set_transformations(png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        let samples = info.color_type.samples();
        let pixels = bytes
            .chunks_exact(samples)
            .map(|p| [p[0], p[1], p[2]])
            .collect();
        Self {
            width: info.width as usize,
            pixels,
        }
    }

    /// Share of the pixels in which two pictures differ by more than a little.
    pub fn difference(&self, other: &Self) -> f64 {
        assert_eq!(
            (self.width, self.pixels.len()),
            (other.width, other.pixels.len())
        );
        let far = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 24);
        let differing = self
            .pixels
            .iter()
            .zip(&other.pixels)
            .filter(|pair| far(*pair))
            .count();
        differing as f64 / self.pixels.len() as f64
    }

    /// Mean colours of a grid of tiles, row by row.
    pub fn tiles(&self, columns: usize, rows: usize) -> Vec<[f64; 3]> {
        let height = self.pixels.len() / self.width;
        let mut sums = vec![([0.0; 3], 0.0); columns * rows];
        for (i, pixel) in self.pixels.iter().enumerate() {
            let (x, y) = (i % self.width, i / self.width);
            let tile = &mut sums[y * rows / height * columns + x * columns / self.width];
            for (sum, value) in tile.0.iter_mut().zip(pixel) {
                *sum += f64::from(*value);
            }
            tile.1 += 1.0;
        }
        sums.iter()
            .map(|(sum, count)| sum.map(|s| s / count))
            .collect()
    }
}

fn unbase64(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::with_capacity(text.len() * 3 / 4);
    for group in text.trim_end_matches('=').as_bytes().chunks(4) {
        let word = group
            .iter()
            .fold(0_u32, |word, c| word << 6 | u32::from(digit(*c)));
        let word = word << (6 * (4 - group.len()));
        bytes.extend(&word.to_be_bytes()[1..group.len()]);
    }
    bytes
}
