//! What a report shows and in which order: the `[[section]]` tables of an experiment file.

use serde::{Deserialize, Serialize};

/// A section of a report.
///
/// As a table of an experiment file its `content` is the key `shows` with the keys of that content beside it; see
/// [`plan`](crate::plan).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Anchor and file name, a word: `table-5.1`.
    pub id: String,
    /// Heading.
    pub title: String,
    /// Text under the heading, Markdown.
    #[serde(default)]
    pub text: String,
    /// What it shows.
    pub content: Content,
}

/// What a section shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", rename_all_fields = "kebab-case")]
pub enum Content {
    /// Nothing but its text.
    Text,
    /// Times, light ratio and VPL count of each configuration in one scene, mean over the runs, beside published ones.
    Times {
        /// Scene.
        scene: String,
        /// Rows.
        configurations: Vec<String>,
        /// Table of the published figures, such as `5.1`.
        published: Option<String>,
        /// Each run on a row of its own instead of their mean.
        #[serde(default)]
        every_run: bool,
    },
    /// How much faster one configuration is than another in every scene, (slow / fast - 1) * 100 %, beside published
    /// figures; with a bar chart.
    Acceleration {
        /// Rows.
        rows: Vec<AccelerationRow>,
        /// Table of the published figures, such as `5.4`.
        published: Option<String>,
        /// Title of the bar chart.
        chart: String,
    },
    /// Pictures of configurations in one scene side by side, with a slider between the first and each other one, and
    /// FLIP maps.
    Images {
        /// Scene.
        scene: String,
        /// Configurations; the first is the left side of every slider.
        configurations: Vec<String>,
        /// Point of the swept parameter.
        point: Option<String>,
    },
    /// How pictures differ from their references: verdict of Perceptual Image Diff and other metrics.
    Agreement {
        /// Rows: configurations, in every scene and against each of their references.
        configurations: Vec<String>,
        /// Columns: keys of metrics.
        metrics: Vec<String>,
        /// Scenes for which the publication says `Pass`.
        #[serde(default)]
        published_pass: Vec<String>,
    },
    /// A quantity against the number of VPLs, a curve per configuration.
    Curves {
        /// Scene.
        scene: String,
        /// Curves.
        configurations: Vec<String>,
        /// Quantity of the y axis.
        quantity: Quantity,
        /// Two configurations: the place where the second becomes the smaller one is marked.
        crossover: Option<[String; 2]>,
    },
    /// Sums of published figures computed again: what does not add up in the publication.
    PublishedArithmetic,
}

/// A row of accelerations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct AccelerationRow {
    /// Its name, as in the published table.
    pub title: String,
    /// Configuration in the numerator.
    pub slow: String,
    /// Configuration in the denominator.
    pub fast: String,
    /// Which time.
    pub time: Time,
}

/// A time of a render.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Time {
    /// The first pass.
    FirstPass,
    /// All that comes after it: photons, light tree, second pass and development.
    SecondPass,
    /// Everything.
    Total,
}

/// A quantity of a chart.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Processor time of light tree and second pass per pixel, in microseconds.
    TimePerPixel,
    /// The same per pixel and VPL, in nanoseconds.
    TimePerVpl,
    /// Shadow rays of both passes per pixel and VPL.
    ShadowRays,
    /// Mean share of the VPLs that were chosen, in percent.
    LightRatio,
    /// A metric against the configuration's first reference, by key.
    Metric(String),
}
