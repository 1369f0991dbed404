//! What the Bevy Remote Protocol does to a world.
//!
//! `bevy_remote` 0.20 depends on `bevy_dev_tools`, and so on Bevy's UI and on ALSA. So these are the same calls of Bevy's reflection as in
//! its `process_remote_*_request`, without the transport.

use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::prelude::*;
use bevy::reflect::serde::{ReflectSerializer, TypedReflectDeserializer};
use bevy::reflect::{PartialReflect, TypePath, TypeRegistration, TypeRegistry};
use serde::de::DeserializeSeed;
use serde_json::Value;

/// The parts of the protocol that read and write a world.
pub(super) trait Remote {
    /// `world.get_components`: a component as JSON.
    fn get(&self, entity: Entity, path: &str) -> Result<Value, String>;

    /// `world.insert_components`.
    fn insert_json(&mut self, entity: Entity, path: &str, value: &Value) -> Result<(), String>;

    /// `world.mutate_components`: changes a field of a component.
    fn mutate(&mut self, entity: Entity, path: &str, field: &str, value: &Value) -> Result<(), String>;

    /// The entity of a resource, on which the methods for resources work.
    fn resource_entity<R: Resource>(&self) -> Entity;

    /// [`Remote::mutate`] for a known type, which has to succeed.
    fn set<C: TypePath>(&mut self, entity: Entity, field: &str, value: impl Into<Value>) {
        let done = self.mutate(entity, C::type_path(), field, &value.into());
        assert_eq!(done, Ok(()), "{field}");
    }

    /// `world.mutate_resources`.
    fn set_resource<R: Resource + TypePath>(&mut self, field: &str, value: impl Into<Value>) {
        self.set::<R>(self.resource_entity::<R>(), field, value);
    }
}

fn registered<'a>(
    registry: &'a TypeRegistry,
    path: &str,
) -> Result<(&'a TypeRegistration, &'a ReflectComponent), String> {
    let registration = registry.get_with_type_path(path);
    let component = registration.and_then(|it| Some((it, it.data::<ReflectComponent>()?)));
    component.ok_or_else(|| format!("`{path}` is no registered component"))
}

fn read(
    registration: &TypeRegistration,
    registry: &TypeRegistry,
    value: &Value,
) -> Result<Box<dyn PartialReflect>, String> {
    let read = TypedReflectDeserializer::new(registration, registry).deserialize(value);
    read.map_err(|error| error.to_string())
}

impl Remote for App {
    fn get(&self, entity: Entity, path: &str) -> Result<Value, String> {
        let registry = self.world().resource::<AppTypeRegistry>().read();
        let (_, component) = registered(&registry, path)?;
        let value = component
            .reflect(self.world().entity(entity))
            .ok_or("it is not there")?;
        let json = serde_json::to_value(ReflectSerializer::new(value.as_partial_reflect(), &registry));
        Ok(json.map_err(|error| error.to_string())?[path].take())
    }

    fn insert_json(&mut self, entity: Entity, path: &str, value: &Value) -> Result<(), String> {
        let registry = self.world().resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        let value = read(registered(&registry, path)?.0, &registry, value)?;
        self.world_mut().entity_mut(entity).insert_reflect(value);
        Ok(())
    }

    fn mutate(&mut self, entity: Entity, path: &str, field: &str, value: &Value) -> Result<(), String> {
        let registry = self.world().resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        let (_, component) = registered(&registry, path)?;
        let mut whole = component
            .reflect_mut(self.world_mut().entity_mut(entity))
            .ok_or("it is not there")?;
        let of = whole
            .reflect_path(field)
            .map_err(|error| error.to_string())?
            .reflect_type_path();
        let registration = registry
            .get_with_type_path(of)
            .ok_or_else(|| format!("`{of}` is not registered"))?;
        let value = read(registration, &registry, value)?;
        let field = whole.reflect_path_mut(field).map_err(|error| error.to_string())?;
        field.try_apply(&*value).map_err(|error| error.to_string())
    }

    fn resource_entity<R: Resource>(&self) -> Entity {
        let world = self.world();
        let id = world.components().get_id(std::any::TypeId::of::<R>());
        let entity = id.and_then(|id| world.resource_entities().get(id));
        entity.expect("the app has the resource")
    }
}
