tangible batch coins.yaml --over 'archive/*.jpg' --set want=relief
# look at: out/coins-batch/gallery.html
