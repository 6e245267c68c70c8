//! What a scene file asks of the integrator.

use super::IntegratorRequest;
use super::loader::Loader;
use super::xml::{ElementId, ElementKind, PropertyValue};
use crate::scene::options::OptionValue;

impl Loader<'_> {
    /// Reads an integrator, and those that it wraps.
    pub(super) fn integrator(&self, id: ElementId) -> IntegratorRequest {
        let mut request = IntegratorRequest::default();
        self.unwrap_integrator(id, &mut request);
        request
    }

    fn unwrap_integrator(&self, id: ElementId, request: &mut IntegratorRequest) {
        let element = &self.tree[id];
        let mut reader = self.reader(id);
        let inner = reader.child(ElementKind::Integrator);
        match element.plugin.as_str() {
            "aov" => {
                let names = reader.string("aovs", "");
                request
                    .aovs
                    .extend(names.split(',').map(|name| name.trim().to_owned()));
                request.aovs.retain(|name| !name.is_empty());
            }
            "moment" => request.second_moment = true,
            plugin if inner.is_some() => {
                let message = format!(
                    "unknown integrator \"{plugin}\"; the one inside of it is used instead"
                );
                for property in &element.properties {
                    reader.ignore(&[&property.name.normalised]);
                }
                reader.replacement("", message);
            }
            _ => {
                request.name.clone_from(&element.plugin);
                request.location = Some(element.location.clone());
                for property in &element.properties {
                    let name = &property.name.normalised;
                    reader.ignore(&[name]);
                    let value = match &property.value {
                        PropertyValue::Boolean(value) => OptionValue::Boolean(*value),
                        PropertyValue::Integer(value) => OptionValue::Integer(*value),
                        PropertyValue::Float(value) => OptionValue::Float(*value),
                        PropertyValue::String(value) => OptionValue::Text(value.clone()),
                        _ => continue,
                    };
                    request.options.insert(name.clone(), value);
                    request
                        .option_locations
                        .insert(name.clone(), property.location.clone());
                }
            }
        }
        if let Some(inner) = inner {
            self.unwrap_integrator(inner, request);
        }
        reader.finish();
    }
}
