"""The world: procedural apartments, a wheeled robot with contacts, cameras, the ObjectNav task and its runner."""
