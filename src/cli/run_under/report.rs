//! What the library wrote down at the end of each process, added up.

use serde_json::Value;

/// What the library wrote, as documents of one line each; their version is the library's.
pub fn lines(text: &str) -> String {
    let objects = text.lines().filter_map(|line| serde_json::from_str(line).ok()).filter(Value::is_object);
    let named = objects.map(|mut object: Value| {
        object["schema"] = "skipgrid.run-under/1".into();
        object
    });
    named.map(|object| format!("{object}\n")).collect()
}

/// The sums over all processes.
#[derive(Debug, Default, PartialEq)]
pub struct Report {
    /// Processes that made an Embree device.
    pub processes: u64,
    /// Lines that are no report.
    pub unread: u64,
    /// Accelerators, each once.
    accelerators: Vec<String>,
    commits: u64,
    build_seconds: f64,
    closest_rays: u64,
    any_rays: u64,
    /// Of the process with most.
    primitives: u64,
    /// Of the process with most.
    bytes: u64,
    errors: u64,
    /// Why, each cause once.
    causes: Vec<String>,
}

impl Report {
    /// Reads a line of JSON for each process.
    pub fn parse(text: &str) -> Self {
        let mut sum = Self::default();
        for line in text.lines().filter(|line| !line.trim().is_empty()) {
            match serde_json::from_str(line) {
                Ok(Value::Object(object)) => sum.add(&Value::Object(object)),
                _ => sum.unread += 1,
            }
        }
        sum
    }

    fn add(&mut self, process: &Value) {
        let number = |key: &str| process[key].as_u64().unwrap_or(0);
        let text = |key: &str| process[key].as_str().filter(|text| !text.is_empty()).map(String::from);
        self.processes += 1;
        self.accelerators.extend(text("accelerator").filter(|name| !self.accelerators.contains(name)));
        self.commits += number("commits");
        self.build_seconds += process["build_seconds"].as_f64().unwrap_or(0.0);
        self.closest_rays += number("closest_rays");
        self.any_rays += number("any_rays");
        self.primitives = self.primitives.max(number("primitives"));
        self.bytes = self.bytes.max(number("bytes"));
        self.errors += number("errors");
        self.causes.extend(text("causes").filter(|causes| !self.causes.contains(causes)));
    }

    /// What was traced, in one sentence.
    pub fn text(&self) -> String {
        let plural = |n: u64| if n == 1 { "" } else { "s" };
        let processes = if self.processes == 1 { String::new() } else { format!(" in {} processes", self.processes) };
        format!(
            "{}: {} rays for the closest hit and {} for any hit, {} build{} in {:.3} s, at most {} primitive{} and {} bytes \
             at once{processes}",
            self.accelerators.join(", "),
            self.closest_rays,
            self.any_rays,
            self.commits,
            plural(self.commits),
            self.build_seconds,
            self.primitives,
            plural(self.primitives),
            self.bytes,
        )
    }

    /// What the library told the program that it cannot do, if so.
    pub fn errors(&self) -> Option<String> {
        let plural = if self.errors == 1 { " was" } else { "s were" };
        (self.errors > 0)
            .then(|| format!("{} error{plural} reported to the program: {}", self.errors, self.causes.join("; ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processes_are_added_up_and_sizes_are_the_greatest() {
        let text = r#"{"accelerator":"grid","devices":1,"commits":2,"build_seconds":0.25,"primitives":7,"bytes":900,"closest_rays":10,"any_rays":1,"errors":0,"causes":""}
{"accelerator":"grid","devices":1,"commits":1,"build_seconds":0.5,"primitives":3,"bytes":100,"closest_rays":5,"any_rays":0,"errors":2,"causes":"no curves; a null"}

no report"#;
        let report = Report::parse(text);
        assert_eq!((report.processes, report.unread), (2, 1));
        assert_eq!(
            report.text(),
            "grid: 15 rays for the closest hit and 1 for any hit, 3 builds in 0.750 s, at most 7 primitives and 900 bytes at \
             once in 2 processes"
        );
        assert_eq!(report.errors().as_deref(), Some("2 errors were reported to the program: no curves; a null"));
    }

    #[test]
    fn lines_name_their_form_and_what_is_none_is_left_out() {
        let named = lines("{\"version\":\"0.0.1\",\"bytes\":3}\nno report\n7\n");
        let value: Value = serde_json::from_str(&named).expect("one line of JSON");
        assert_eq!(value, serde_json::json!({ "schema": "skipgrid.run-under/1", "version": "0.0.1", "bytes": 3 }));
    }

    #[test]
    fn nothing_is_no_process() {
        assert_eq!(Report::parse(""), Report::default());
        assert_eq!(Report::default().errors(), None);
    }
}
