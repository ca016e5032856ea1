tangible describe parts-printed.yaml
