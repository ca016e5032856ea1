"""The stages: one module a product, with the class `ProductStage`; found by the name of the product."""
