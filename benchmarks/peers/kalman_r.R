# SPDX-License-Identifier: Apache-2.0
# The likelihoods of kalman_benchmark.cpp by R's KalmanLike, which takes one output.
#
# Rscript kalman_r.R FILE TASK, TASK "likelihood" or "fit". Its input and output are described in
# kalman_statsmodels.py; the fit is optim's BFGS in log-variances.
arguments <- commandArgs(trailingOnly = TRUE)
m <- list()
for (line in readLines(arguments[1])) {
  words <- strsplit(line, " ", fixed = TRUE)[[1]]
  m[[words[1]]] <- matrix(as.numeric(words[-(1:3)]), as.integer(words[2]), as.integer(words[3]),
                          byrow = TRUE)
}
y <- as.vector(m$y)

# With nit = 0 the first prediction's covariance is Pn, and its mean T a.
model <- list(T = m$F, Z = as.vector(m$C), h = m$R[1, 1], V = m$Q, a = rep(0, nrow(m$F)),
              P = m$P0, Pn = m$P0)

# -log p of its mean square s2 and its mean logarithm, which it gives as 0.5 (log s2 + mean).
minus_log_likelihood <- function(model) {
  z <- KalmanLike(y, model)
  0.5 * length(y) * (log(2 * pi) + z$s2 + 2 * z$Lik - log(z$s2))
}

# Processor time, which R reports in thousandths.
seconds_of <- function(work) {
  start <- proc.time()
  work()
  spent <- proc.time() - start
  spent[["user.self"]] + spent[["sys.self"]]
}

evaluations <- 0
objective <- function(parameters) {
  evaluations <<- evaluations + 1
  model$V <- m$Q_of_1 * exp(parameters[1])
  model$h <- exp(parameters[2])
  minus_log_likelihood(model) / length(y)
}

write <- function(...) cat(sprintf("%.17g", c(...)), "\n")
if (arguments[2] == "fit") {
  result <- NULL
  seconds <- seconds_of(function() {
    result <<- optim(as.vector(m$start), objective, method = "BFGS",
                     control = list(reltol = 1e-14, ndeps = c(1e-4, 1e-4)))
  })
  write(seconds, -result$value * length(y), evaluations, exp(result$par))
} else {
  value <- minus_log_likelihood(model)
  times <- 100
  many <- function() for (i in seq_len(times)) KalmanLike(y, model)
  write(median(replicate(15, seconds_of(many))) / times, -value)
}
