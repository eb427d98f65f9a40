!> Chains of volumes against closed forms of the half-space: a constant scalar at the face, a
!! constant flux, and a constant supply to a face that stores too, in short steps and in steps that
!! double; steady flow, also at once; balance, symmetry, no negative coefficients.
program test_coarse_chain
   use base_kinds, only: pi, rk
   use coarse_chain, only: chain_t, new_chain, node_count
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: thickness = 1.0_rk, length = 2.0_rk  !< [m]
   real(rk), parameter :: conductivity = 3.0e-16_rk  !< [m2/(Pa s)]
   real(rk), parameter :: storage = 5.0e-11_rk  !< [1/Pa]
   real(rk), parameter :: diffusivity = conductivity/storage
   real(rk), parameter :: first(3) = [0.02_rk, 2.0e-3_rk, 1.0e-4_rk]  !< first volumes [m]
   !> Times of comparison: up to a layer of so many thicknesses of the chain [-].
   real(rk), parameter :: to = 0.3_rk
   integer, parameter :: given_scalar = 1, given_flux = 2, given_supply = 3
   type(checks_t) :: checks
   integer :: i

   do i = 1, size(first)
      call test_sums(first(i))
      call test_steady(first(i))
      call test_long_steps(first(i))
      call test_uptake_error(first(i))
      call compare(first(i), given_scalar, 1.02_rk, 2.0_rk, 0.03_rk, "constant scalar")
      call compare(first(i), given_flux, 1.02_rk, 2.0_rk, 0.03_rk, "constant flux")
      call compare(first(i), given_supply, 1.02_rk, 2.0_rk, 0.03_rk, "constant supply")
   end do
   ! Doubled steps: 1 % in time, a quarter of what one implicit step leaves, and .5 % in space.
   call compare(first(3), given_flux, 2.0_rk, 4.0_rk, 0.02_rk, "constant flux, doubled steps")
   call compare(first(3), given_supply, 2.0_rk, 4.0_rk, 0.02_rk, "constant supply, doubled steps")
   call checks%is_true(all(node_count(1.0_rk, [0.1_rk, 4.0e-3_rk, 1.0e-4_rk]) == [7, 10, 14]), &
                       "number of nodes")
   call test_sums(thickness)  ! not to be had: the volumes are equal
   call checks%finish()

contains

   !> The volumes fill the layer; resistances add up; the elimination is symmetric.
   subroutine test_sums(first_volume)
      real(rk), intent(in) :: first_volume  !< [m]
      type(chain_t) :: chain

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      call chain%prepare(1.0e3_rk)
      associate (n => chain%n, g => chain%conductance)
         call checks%is_close(sum(chain%volume), thickness*length, 1.0e-12_rk, "volume")
         call checks%is_close(sum(1.0_rk/g)*length*conductivity, chain%place(n), 1.0e-12_rk, &
                              "resistance")
         call checks%is_true(all(chain%volume(2:)/chain%volume(:n - 1) < 4.0_rk), "ratio")
         ! A difference of flows, rounded at up to 1e6 times its size
         call checks%is_close(flow_at_end(chain)/(g(0)*chain%near_face(2)), 1.0_rk, 1.0e-9_rk, &
                              "symmetry of both ends")
         call checks%is_close(dot_product(chain%volume(:n - 1), chain%alpha) &
                              /(1.0e3_rk*g(0)*chain%mean_gamma(1)), 1.0_rk, 1.0e-12_rk, &
                              "symmetry of mu and the face")
         call checks%is_close(dot_product(chain%volume(:n - 1), chain%beta) &
                              /(1.0e3_rk*g(n - 1)*chain%mean_gamma(2)), 1.0_rk, 1.0e-12_rk, &
                              "symmetry of mu and the outer end")
         call checks%is_true(all([chain%alpha, chain%beta, chain%gamma, chain%near_face, &
                                  chain%mean_weight - chain%near_face(1), &
                                  chain%mean_weight - chain%near_end] >= 0.0_rk), &
                             "no negative coefficients")
      end associate
   end subroutine test_sums

   !> The error of what is taken up: 11 % of it once a layer is
   !! as thick as the first volume, .5 % from three times that on (budget: the error of nodes at
   !! geometric means). The rest of the rock counts by exp(-2 l/sqrt(c t)) where layers are thin,
   !! and in full, as far as cells do not resolve them, where they are thick (budget: 3 %, the
   !! resistance of the chain).
   subroutine test_uptake_error(first_volume)
      real(rk), intent(in) :: first_volume  !< [m]
      type(chain_t) :: chain
      real(rk) :: depth  ! sqrt(c t) [m]
      integer :: k

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      call checks%is_close(chain%uptake_error(first_volume**2/diffusivity, 0.0_rk), 0.11_rk, &
                           0.02_rk, "a layer as thick as the first volume")
      do k = 0, 4
         depth = min(0.3_rk*thickness, 3.5_rk*first_volume*2.0_rk**k)
         call checks%is_true(chain%uptake_error(depth**2/diffusivity, 0.0_rk) < 0.005_rk, &
                             "thin layers")
         call checks%is_close(effect(chain, depth), exp(-2.0_rk*thickness/depth) &
                              /(1.0_rk + (0.25_rk*depth/thickness)**2), 0.02_rk, &
                              "what lies beyond the chain")
      end do
      call checks%is_close(effect(chain, 100.0_rk*thickness), 1.0_rk/(1.0_rk + 25.0_rk**2), &
                           0.03_rk/(1.0_rk + 25.0_rk**2), "thick layers")
   end subroutine test_uptake_error

   !> Effect of the error of the rest for a layer of a depth, over this error [-].
   real(rk) function effect(chain, depth)
      type(chain_t), intent(in) :: chain
      real(rk), intent(in) :: depth  !< sqrt(c t) [m]
      real(rk), parameter :: of_rest = 1.0e-3_rk

      associate (time => depth**2/diffusivity)
         effect = (chain%uptake_error(time, of_rest) - chain%uptake_error(time, 0.0_rk))/of_rest
      end associate
   end function effect

   !> Flow at the outer end in a step by the scalar at the face after it, over the step length, by
   !! the balance of a step from rest.
   real(rk) function flow_at_end(chain)
      type(chain_t), intent(in) :: chain

      associate (n => chain%n)
         flow_at_end = chain%conductance(0)*(chain%mean_weight - chain%near_face(1)) &
                       - storage*dot_product(chain%volume(:n - 1), chain%alpha)/chain%dt
      end associate
   end function flow_at_end

   !> A constant flow into a face that stores nothing, out of the outer end, in steps longer than
   !! all times of the chain: the scalar at the face does not oscillate.
   subroutine test_long_steps(first_volume)
      real(rk), intent(in) :: first_volume  !< [m]
      real(rk), parameter :: longer(3) = [1.0_rk, 10.0_rk, 1.0e4_rk]
      type(chain_t) :: chain
      real(rk), allocatable :: p(:), rho(:)
      real(rk) :: face, means(2), steady
      integer :: i, k

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      steady = sum(1.0_rk/chain%conductance)
      do i = 1, size(longer)
         call chain%prepare(longer(i)*thickness**2/diffusivity)
         p = spread(0.0_rk, 1, int(chain%n) - 1)
         rho = p
         face = 0.0_rk
         do k = 1, 10
            call chain%stored(p, [face, 0.0_rk], rho, means)
            associate (weight => chain%mean_weight, g => chain%conductance(0))
               face = (1.0_rk/g + means(1) - (1.0_rk - weight)*face)/(weight - chain%near_face(1))
            end associate
            p = chain%inner(rho, 0.0_rk, face, 0.0_rk)
            if (k == 1) call checks%is_true(face < 1.03_rk*steady, "first long step")
            if (k == 3) call checks%is_close(face/steady, 1.0_rk, 0.03_rk, "third long step")
         end do
         call checks%is_close(face/steady, 1.0_rk, 1.0e-4_rk, "tenth long step")
      end do
   end subroutine test_long_steps

   !> After a step longer than all times of the layer the flux is that of the resistance alone.
   subroutine test_steady(first_volume)
      real(rk), intent(in) :: first_volume  !< [m]
      type(chain_t) :: chain
      real(rk), allocatable :: p(:)
      real(rk) :: means(2)

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      call chain%prepare(1.0e12_rk*thickness**2/diffusivity)
      allocate (p(chain%n - 1))
      call chain%stored(spread(0.3_rk, 1, int(chain%n) - 1), [0.2_rk, 0.4_rk], p, means)
      p = chain%inner(p, 0.0_rk, 1.0_rk, 0.5_rk)
      call checks%is_close(chain%conductance(0)*(1.0_rk - p(1)) &
                           /(0.5_rk*conductivity*length/chain%place(chain%n)), 1.0_rk, 1.0e-7_rk, &
                           "steady flux")
   end subroutine test_steady

   !> The chain, closed at its outer end, from rest in steps that grow from very short ones.
   subroutine compare(first_volume, kind, growth, from, tolerance, name)
      real(rk), intent(in) :: first_volume  !< [m]
      integer, intent(in) :: kind  !< of the condition at the face
      real(rk), intent(in) :: growth  !< of the steps [-]
      real(rk), intent(in) :: from  !< thickness of the layer, over that of the first volume [-]
      real(rk), intent(in) :: tolerance
      character(len=*), intent(in) :: name
      type(chain_t) :: chain
      real(rk), allocatable :: p(:), rho(:)
      real(rk) :: dt, exact, face, found, held, inflow, largest, means(2), rows(2, 2), rhs(2)
      real(rk) :: before(2), flow(2), time, weight, width

      chain = new_chain(thickness, first_volume, length, conductivity, storage)
      allocate (p(chain%n), rho(chain%n - 1), source=0.0_rk)
      dt = 1.0e-3_rk*first_volume**2/diffusivity
      time = 0.0_rk
      face = 0.0_rk
      inflow = 0.0_rk
      largest = 0.0_rk
      ! So much that the layer in the rock holds as much when it is a tenth of the chain thick.
      held = 0.0_rk
      if (kind == given_supply) held = 0.1_rk*storage*thickness*length
      associate (n => chain%n, g => chain%conductance)
         do
            call chain%prepare(dt)
            weight = chain%mean_weight
            if (kind == given_scalar) face = 1.0_rk
            before = [face, p(n)]
            call chain%stored(p(:n - 1), before, rho, means)
            flow = dt*[g(0), g(n - 1)]*(means - (1.0_rk - weight)*before)
            ! The face and the last node: balances, with the inner nodes eliminated.
            rows(1, :) = [held + dt*g(0)*(weight - chain%near_face(1)), -dt*g(0)*chain%near_face(2)]
            rows(2, :) = [-dt*g(0)*chain%near_face(2), &
                          storage*chain%volume(n) + dt*g(n - 1)*(weight - chain%near_end)]
            rhs = [dt + held*face + flow(1), storage*chain%volume(n)*p(n) + flow(2)]
            if (kind == given_scalar) then
               rows(1, :) = [1.0_rk, 0.0_rk]
               rhs(1) = 1.0_rk
            end if
            rhs = [rows(2, 2)*rhs(1) - rows(1, 2)*rhs(2), rows(1, 1)*rhs(2) - rows(2, 1)*rhs(1)] &
                  /(rows(1, 1)*rows(2, 2) - rows(1, 2)*rows(2, 1))
            face = rhs(1)
            p = [chain%inner(rho, 0.0_rk, face, rhs(2)), rhs(2)]
            inflow = inflow + dt*g(0)*(weight*face + (1.0_rk - weight)*before(1) &
                                       - means(1) - dot_product(chain%near_face, rhs))
            time = time + dt
            width = sqrt(diffusivity*time)
            if (width > to*thickness) exit
            dt = dt*growth
            if (width < from*first_volume) cycle
            select case (kind)
            case (given_scalar)
               found = inflow
               exact = 2.0_rk*storage*length*width/sqrt(pi)
            case (given_flux)
               found = face
               exact = 2.0_rk*width/(conductivity*length)/sqrt(pi)
            case default
               found = face
               associate (s => storage*length*sqrt(diffusivity)/held)
                  exact = (2.0_rk*s*sqrt(time/pi) - 1.0_rk + erfc_scaled(s*sqrt(time)))/(held*s**2)
               end associate
            end select
            largest = max(largest, abs(found/exact - 1.0_rk))
         end do
         call checks%is_close(largest, 0.0_rk, tolerance, name)
         call checks%is_close(storage*dot_product(chain%volume, p)/inflow, 1.0_rk, 1.0e-9_rk, &
                              name//": balance")
      end associate
   end subroutine compare

end program test_coarse_chain
