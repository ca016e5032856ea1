tangible feel coins.yaml --seconds 2 --record hand.nc
tangible replay hand.nc coins.yaml --set 'render={use: penalty}'
