tangible preflight steep.yaml --fix fixed.yaml
