//! The head of every JSON document: the name and version of its form, which `docs/json.md` describes, and the program's version.

use crate::measure::Machine;
use serde_json::Value;

/// `body`, an object, as a document of the form `schema`, such as `skipgrid.bench/1`.
///
/// The number grows only when a field goes, is renamed or means something else; a new field leaves it.
pub fn document(schema: &str, mut body: Value) -> Value {
    body["schema"] = schema.into();
    body["version"] = env!("CARGO_PKG_VERSION").into();
    body
}

/// As [`document`], of what was measured on `machine`.
pub fn measured(schema: &str, machine: &Machine, mut body: Value) -> Value {
    body["cpu"] = machine.cpu.as_str().into();
    body["threads"] = machine.threads.into();
    body["code"] = machine.features.into();
    body["debug"] = machine.debug.into();
    document(schema, body)
}
