"""The words of the project: frozen models of recipes, manifests, configs and scores, and the errors."""
